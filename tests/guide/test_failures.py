"""Which condition ended a walk, where and by how much, on the map and on the polygons."""

import json
from typing import Any

import jax.numpy as jnp
import numpy as np
import pytest

from jaxleas.conditions import collision, strict_reachability
from jaxleas.envs.steering import SteeringConfig, SteeringEnv
from jaxleas.files import write_npz
from jaxleas.guide import read_guide_paths, write_guide_paths
from jaxleas.guide.commands import rollout
from jaxleas.guide.failures import Failure, failures_on_map
from jaxleas.guide.reconfirming import EndedPaths, reconfirm
from jaxleas.robots import load_talos
from jaxleas.terrain import HeightMap, Scene, make_atlas, write_height_map, write_scene
from jaxleas.training.policy import write_policy
from jaxleas.types import GuidePath, InputError, RootMotion
from tests.contacts.sampling.worlds import flat, floor, straight, wall
from tests.guide.walkers import flat_map, random_policy

ENV = SteeringEnv(SteeringConfig())
POST = {"post": floor(1.195, 1.205, 0.036, 0.044, 0.9)}
"""A thing that no middle of a cell lies on, at the height of the trunk."""


def ended_at(x: float, z: float) -> GuidePath:
    path = straight(0.2, height=z, start=x - 0.2)
    return path[np.arange(len(path))]


def test_the_worst_condition_is_named_with_its_margin() -> None:
    heights = flat_map().heights.copy()
    terrain = HeightMap(heights, flat_map().resolution, flat_map().origin)
    paths = [ended_at(0.5, 1.9), ended_at(0.5, 0.95), ended_at(0.5, 0.2)]
    found = failures_on_map(ENV, terrain, paths, ["invalid", "stopped", "invalid"])
    assert found[1] is None
    ends = RootMotion(
        jnp.array([paths[0].position[-1], paths[2].position[-1]], jnp.float32),
        jnp.zeros((2, 3)),
        jnp.zeros(2),
    )
    local = ENV.local_heights(make_atlas([terrain]), jnp.zeros(2, jnp.int32), ends)
    expected = {
        "strict_reachability": strict_reachability(ENV.robot, ENV.points_in_root)(local, ends),
        "collision": collision(ENV.robot, ENV.points_in_root)(local, ends),
    }
    for row, failure in enumerate((found[0], found[2])):
        assert failure is not None
        margins = {name: float(each[row]) for name, each in expected.items()}
        assert failure.condition == min(margins, key=lambda name: margins[name])
        assert failure.margin == pytest.approx(min(margins.values()), abs=1e-6)
        assert (failure.margin or 0.0) < 0.0
    high = found[0]
    assert high is not None
    assert high.condition == "strict_reachability"
    assert "R* fails at (0.50, 0.00), 2.0 s: margin -" in high.at(paths[0])


def test_polygons_end_a_path_that_the_map_let_pass() -> None:
    path, free = straight(2.0), straight(2.0, y=1.0)
    walked = EndedPaths((path, free), ("reached", "stopped"), (None, None))
    names = ("strict_reachability", "collision")
    found = reconfirm(load_talos(), Scene(flat().surfaces, POST), names, walked)
    assert found.reasons == ("invalid", "stopped")
    assert (found.refused(), found.mistaken()) == (1, 0)
    cut = found.paths[0]
    assert cut.valid[:-1].all()
    assert not cut.valid[-1]
    reach = load_talos().trunk[0].high[0]
    assert cut.position[-1, 0] == pytest.approx(1.195 - reach, abs=0.021)
    assert found.failures[0] == Failure("collision", None, exactly=True)
    assert Failure("collision", None, exactly=True).at(cut).endswith(", on the terrain's polygons")
    assert len(found.paths[1]) == len(free)
    alone = reconfirm(load_talos(), Scene(flat().surfaces, POST), names[:1], walked)
    assert alone.reasons == walked.reasons  # C did not judge on the map, nor does its twin


def test_a_refusal_of_the_map_alone_stands_and_is_said() -> None:
    path = straight(1.0)
    path.valid[-1] = False
    mistaken = EndedPaths((path,), ("invalid",), (Failure("collision", -0.02),))
    found = reconfirm(load_talos(), flat(), ("collision",), mistaken)
    assert found.reasons == ("invalid",)
    assert found.mistaken() == 1
    (failure,) = found.failures
    assert failure is not None
    assert "margin -0.02 m (the exact conditions hold there)" in failure.at(path)
    inside = straight(1.0, start=1.48)
    inside.valid[:] = np.arange(len(inside)) < 20
    right = EndedPaths((inside[:21],), ("invalid",), (Failure("collision", -0.5),))
    assert reconfirm(load_talos(), wall(), ("collision",), right).mistaken() == 0


def test_failures_survive_a_file(tmp_path) -> None:
    failures = [Failure("collision", -0.25), None, Failure("collision", None, exactly=True)]
    paths = [straight(0.1)] * 3
    file = tmp_path / "p.npz"
    write_guide_paths(file, paths, ["invalid", "reached", "invalid"], failures=failures)
    assert read_guide_paths(file).failures == tuple(failures)
    stored = np.load(file, allow_pickle=False)["failed"]
    assert stored.tolist() == ["collision", "", "exact collision"]  # docs/files.md
    write_guide_paths(file, paths, ["invalid", "reached", "invalid"])
    assert read_guide_paths(file).failures == ()
    arrays = dict(np.load(file, allow_pickle=False))
    write_npz(file, **arrays, failed=np.array(["collision"]))
    with pytest.raises(InputError, match="failed and failed_margin must be a text and a number"):
        read_guide_paths(file)


@pytest.fixture
def work(tmp_path) -> dict[str, Any]:
    """A floor with a post that its map of 4 cm does not hold, and one walk past it."""
    write_policy(tmp_path / "policy.npz", random_policy(seed=4))
    write_scene(tmp_path / "scene.json", Scene({"floor": floor(-2, 6, -2, 2)}, POST))
    write_height_map(tmp_path / "map.npz", flat_map())
    query = {"position": [0, 0, 0.95], "yaw": 0.0, "velocity": [0, 0, 0], "goal": [2.0, 0.0]}
    (tmp_path / "q.json").write_text(json.dumps([query]))
    return {
        "policy": tmp_path / "policy.npz",
        "queries": tmp_path / "q.json",
        "out": tmp_path / "p.npz",
        "steering": "lin",
    }


def test_rollout_reconfirms_where_there_are_polygons(work, tmp_path, capsys) -> None:
    scene = tmp_path / "scene.json"
    rollout(**work, terrain=scene)
    said = capsys.readouterr().out
    assert "0 reached their goal, 1 ended invalid (1 by the exact conditions alone)" in said
    assert "query 0: collision C fails at (1.0" in said
    assert read_guide_paths(work["out"]).reasons == ("invalid",)
    rollout(**work, terrain=scene, exact=False)
    assert "1 reached their goal, 0 ended invalid, 0" in capsys.readouterr().out


def test_a_map_has_no_polygons_which_is_said_if_asked(work, tmp_path, capsys, caplog) -> None:
    rollout(**work, terrain=tmp_path / "map.npz")
    assert "1 reached their goal" in capsys.readouterr().out
    assert not caplog.text
    rollout(**work, terrain=tmp_path / "map.npz", exact=True)
    assert "has no polygons: no exact check is possible" in caplog.text
