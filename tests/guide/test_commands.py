import json

import numpy as np
import pytest

from jaxleas.export import build_onnx
from jaxleas.export.write import described
from jaxleas.files import write_json
from jaxleas.guide import load_policy, read_guide_paths
from jaxleas.guide.commands import rollout
from jaxleas.terrain import write_height_map
from jaxleas.training.policy import write_policy
from jaxleas.types import InputError
from tests.guide.walkers import flat_map, random_policy

POLICY = random_policy(seed=4)
QUERIES = [
    {"position": [0, 0, 0.95], "yaw": 0.5, "velocity": [0, 0, 0], "goal": [1.0, 0.5]},
    {"position": [0, 0, 0.95], "yaw": 7.0, "velocity": [0, 0, 0], "goal": [0.1, 0]},
    {"position": [1, 1, 1.9], "yaw": 0.0, "velocity": [0.1, 0, 0], "goal": [-2, 0]},
    {"position": [3.9, 0, 0.95], "yaw": 0.0, "velocity": [0, 0, 0], "goal": [50, 0]},
]


@pytest.fixture
def files(tmp_path):
    """Everything a roll-out is given."""
    write_policy(tmp_path / "policy.npz", POLICY)
    (tmp_path / "policy.onnx").write_bytes(build_onnx(POLICY, described(POLICY.config)))
    write_height_map(tmp_path / "map.npz", flat_map())
    (tmp_path / "queries.json").write_text(json.dumps(QUERIES))
    return {
        "policy": tmp_path / "policy.npz",
        "terrain": tmp_path / "map.npz",
        "queries": tmp_path / "queries.json",
        "out": tmp_path / "out.npz",
    }


def test_rb_lin_reaches_what_lies_on_level_ground(files, capsys):
    picture = files["out"].with_suffix(".png")
    rollout(**files, steering="lin", picture=picture)
    said = capsys.readouterr().out
    assert "of 4 queries 2 reached their goal, 2 ended invalid, 0 stopped" in said
    off_the_map, third_failed, fourth_failed = said.splitlines()[1:]
    assert off_the_map.startswith("off the map, which spans x in [-4")
    assert off_the_map.endswith("lie the goals of 1 queries: 3")
    assert third_failed.startswith("query 2: strict reachability R* fails at (1.00, 1.00), 0.0 s: ")
    assert "query 3: strict reachability R* fails at (4." in fourth_failed
    walked = read_guide_paths(files["out"])
    assert walked.reasons == ("reached", "reached", "invalid", "invalid")
    first, second, third, fourth = walked.paths
    np.testing.assert_allclose(first.position[0], [0, 0, 0.95], atol=1e-6)
    assert np.linalg.norm(first.position[-1, :2] - [1.0, 0.5]) <= 0.2 + 1e-6
    np.testing.assert_allclose(np.diff(first.time), 0.2)
    assert len(second) == 1  # 7.0 rad is a heading like any other; the goal was there
    assert len(third) == 1  # too high above ground to stand: one invalid configuration
    assert not third.valid[0]
    assert 1 < len(fourth) < 30  # off the edge of the map
    assert picture.read_bytes().startswith(b"\x89PNG")


def test_policy_and_onnx_file_walk_alike(files):
    rollout(**files, steps=40)
    first = read_guide_paths(files["out"])
    rollout(**{**files, "policy": files["policy"].with_suffix(".onnx")}, steps=40)
    second = read_guide_paths(files["out"])
    assert first.reasons == second.reasons
    for left, right in zip(first.paths, second.paths, strict=True):
        np.testing.assert_allclose(left.position, right.position, atol=1e-4)
    assert max(map(len, first.paths)) > 10


def test_a_guard_can_be_asked_for_and_keeps_what_begins_valid(files):
    """Random weights walk until they fail; guarded, until they must stop."""
    for guard in (False, True):
        rollout(**files, steps=150, guard=guard)
        paths = read_guide_paths(files["out"]).paths
        begun_valid = [path.valid for path in paths if path.valid[0]]
        assert len(begun_valid) >= 2
        assert all(each.all() for each in begun_valid) is guard


def test_a_guard_over_what_is_no_policy_is_refused(files):
    with pytest.raises(InputError, match="--guard watches over a policy's walks"):
        rollout(**files, steering="kino", guard=True)


def test_a_run_folder_stands_for_its_best_policy(files, tmp_path):
    run = tmp_path / "run"
    run.mkdir()
    (run / "config.yaml").write_text("{}\n")
    write_json(run / "provenance.json", {"format": 1})
    with pytest.raises(InputError, match=r"holds no policy\.npz yet"):
        load_policy(run)
    write_policy(run / "policy.npz", POLICY)
    assert load_policy(run).config == POLICY.config


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"policy": "nothing"}, "does not exist"),
        ({"policy": "nothing.onnx"}, "does not exist"),
        ({"policy": "queries.json"}, "not a policy"),
        ({"policy": "map.npz"}, "lacks the array"),
        ({"policy": "."}, "not a run folder"),
        ({"terrain": "nothing.npz"}, "does not exist"),
        ({"terrain": "cloud.las"}, "is a cloud of points that is not read"),
        ({"terrain": "policy.npz"}, "lacks the array"),
        ({"queries": "nothing.json"}, "does not exist"),
        ({"out": "out.csv"}, "written as .npz"),
        ({"picture": "out.gif"}, "pictures are"),
    ],
)
def test_unusable_files_are_refused(files, tmp_path, change, says):
    given = {**files, **{key: tmp_path / name for key, name in change.items()}}
    with pytest.raises(InputError, match=says):
        rollout(**given)
    assert not (tmp_path / "out.npz").exists()


@pytest.mark.parametrize(("steps", "says"), [(0, "--steps is 0"), (10_000_000, "configurations")])
def test_absurd_numbers_of_steps_are_refused(files, steps, says):
    with pytest.raises(InputError, match=says):
        rollout(**files, steps=steps)


def test_queries_off_the_map_are_refused(files):
    files["queries"].write_text(json.dumps([{**QUERIES[0], "position": [99, 0, 1]}]))
    with pytest.raises(InputError, match="off the map"):
        rollout(**files)


OWN_METHOD = '''
from jaxleas.types import RootMotion


class Slide:
    """Moves roots sideways, whatever is there."""

    def __init__(self, limits, desired_speed):
        self.step = limits.time_step * desired_speed

    def __call__(self, heights_in_root, motion, goal):
        return RootMotion(motion.position.at[..., 1].add(self.step), motion.velocity, motion.yaw)
'''


def test_a_steering_method_of_ones_own_walks(files, tmp_path, monkeypatch):
    monkeypatch.syspath_prepend(str(tmp_path))
    (tmp_path / "slide.py").write_text(OWN_METHOD)
    rollout(**files, steering="slide:Slide", steps=5)
    path = read_guide_paths(files["out"]).paths[0]
    np.testing.assert_allclose(np.diff(path.position[:, 1]), 0.02, atol=1e-5)
    np.testing.assert_array_equal(np.diff(path.position[:, 0]), 0.0)


def test_an_unknown_steering_method_gets_the_nearest_and_the_list(files):
    with pytest.raises(InputError, match="'kimo'; perhaps you meant kino; there are leas"):
        rollout(**files, steering="kimo")
    assert not files["out"].exists()


@pytest.mark.slow
def test_paths_with_noise_are_judged_on_the_true_terrain(files, capsys):
    rollout(**files, noise=["white=0.02", "missing=0.02"], steps=5)
    assert "of 4 queries" in capsys.readouterr().out
    walked = read_guide_paths(files["out"])
    assert walked.paths[0].valid.all()


@pytest.mark.parametrize(
    ("options", "says"),
    [
        ({"noise": ["missing=1"]}, "no height known around the start of query 0"),
        ({"noise": ["holes=2"]}, "--noise: holes is 2"),
        ({"noise": ["white=0.1"], "noise_seed": -1}, "--noise-seed is -1"),
    ],
)
def test_impossible_noise_is_refused(files, options, says):
    with pytest.raises(InputError, match=says):
        rollout(**files, **options)
    assert not files["out"].exists()
