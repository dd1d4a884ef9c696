"""Under which conditions a policy walks that was trained under others; it may be a stranger's."""

import json
import sys

import pytest

from jaxleas.conditions.named import STANDARD, SurrogateSettings
from jaxleas.evaluation.examination import load_candidate
from jaxleas.export import build_onnx
from jaxleas.export.write import described
from jaxleas.guide import load_policy, read_guide_paths
from jaxleas.guide.commands import rollout
from jaxleas.terrain import write_height_map
from jaxleas.training.policy import read_policy, write_policy
from jaxleas.types import InputError

from .walkers import flat_map, homing_policy

OWN = '''
import numpy as np


class Nowhere:
    """Hold nowhere beyond x = 1 m of the walk's start, whatever the ground."""

    def __init__(self, robot, candidates):
        self.points_in_root = np.zeros((1, 2))

    def __call__(self, heights_in_root, motion):
        return 1.0 - motion.position[..., 0]
'''
MINE = "strangers_conditions:Nowhere"


@pytest.fixture
def folder(tmp_path, monkeypatch):
    (tmp_path / "strangers_conditions.py").write_text(OWN)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "path", list(sys.path))
    yield tmp_path
    sys.modules.pop("strangers_conditions", None)


def write(folder, *conditions):
    policy = homing_policy(conditions=conditions)
    write_policy(folder / "policy.npz", policy)
    (folder / "policy.onnx").write_bytes(build_onnx(policy, described(policy.config)))


@pytest.mark.parametrize("name", ["policy.npz", "policy.onnx"])
def test_code_that_a_policy_names_runs_with_permission_only(folder, name, caplog):
    write(folder, *STANDARD, MINE)
    with caplog.at_level("WARNING"):
        assert load_policy(name).config.conditions == STANDARD
    assert f"trained under {', '.join([*STANDARD, MINE])}; it walks under" in caplog.text
    assert f"give --allow {MINE}" in caplog.text
    assert load_policy(name, [MINE]).config.conditions == (*STANDARD, MINE)
    assert "strangers_conditions" not in sys.modules
    assert read_policy("policy.npz").config.conditions == (*STANDARD, MINE)


def test_a_policy_is_judged_by_its_own_conditions_where_they_are_allowed(folder):
    write(folder, *STANDARD, MINE)
    plain, own = load_candidate("policy.npz"), load_candidate("policy.npz", allow=[MINE])
    assert plain.terms.conditions == plain.env.config.conditions == STANDARD
    assert f"judged under {', '.join(STANDARD)}; if you trust" in plain.note
    assert f"--allow {MINE}" in plain.note
    assert own.terms.conditions == own.env.config.conditions == (*STANDARD, MINE)
    assert plain.terms.are_standard
    assert not own.terms.are_standard
    assert own.terms.describe() == {"conditions": (*STANDARD, MINE), "foresight": None}


def test_a_part_of_the_conditions_does_not_judge(folder):
    write(folder, *STANDARD, MINE, SurrogateSettings(surrogate="/nowhere/surrogate.npz"))
    with pytest.raises(InputError, match="all of them or none, and a surrogate's file"):
        load_candidate("policy.npz", allow=[MINE])


def test_a_surrogate_that_a_policy_names_is_left_alone(folder):
    write(folder, *STANDARD, SurrogateSettings(surrogate="/nowhere/surrogate.npz"))
    assert load_policy("policy.npz").config.conditions == STANDARD


def test_built_in_conditions_are_walked_under_but_judged_by_strict_reachability(folder, caplog):
    write(folder, "reachability", "collision")
    with caplog.at_level("WARNING"):
        assert load_policy("policy.npz").config.conditions == ("reachability", "collision")
    assert not caplog.text
    assert load_candidate("policy.npz").env.config.conditions == STANDARD


def test_a_rollout_ends_where_an_allowed_condition_fails(folder):
    write(folder, *STANDARD, MINE)
    write_height_map("map.npz", flat_map())
    query = {"position": [0, 0, 0.95], "yaw": 0.0, "velocity": [0, 0, 0], "goal": [2.0, 0.0]}
    (folder / "queries.json").write_text(json.dumps([query]))
    files = {
        "policy": folder / "policy.npz",
        "terrain": folder / "map.npz",
        "queries": folder / "queries.json",
        "out": folder / "out.npz",
    }
    rollout(**files)
    assert read_guide_paths("out.npz").reasons == ("reached",)
    rollout(**files, allow=[MINE])
    walked = read_guide_paths("out.npz")
    assert walked.reasons == ("invalid",)
    assert walked.paths[0].position[-1, 0] == pytest.approx(1.0, abs=0.05)
