"""What a sweep cannot mean is refused in one sentence with file and key, before anything runs."""

import subprocess
import sys

import pytest

from jaxleas.sweeps.border import open_sweep
from jaxleas.sweeps.population_config import open_population
from jaxleas.types import InputError
from tests.sweeps.files import write_population, write_sweep
from tests.training.runs import ROOT

RATE = "ppo.learning_rate"
LINEAR = {"low": 0.1, "high": 0.2}


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        (
            {"space": {"ppo.learning_rte": LINEAR}},
            "there is no ppo.learning_rte; perhaps you meant ppo.learning_rate",
        ),
        ({"space": {"ppo": LINEAR}}, "ppo is a section: give a field of it, such as ppo.steps"),
        ({"space": {}}, "space is empty"),
        (
            {"space": {RATE: {"low": 2e-3, "high": 1e-3}}},
            "space.ppo.learning_rate: low = 0.002 is above high = 0.001",
        ),
        ({"space": {RATE: {"low": 1e-3, "high": 1e-3}}}, "the range is empty"),
        ({"space": {RATE: {"low": 0.0, "high": 1e-3, "log": True}}}, "log needs numbers above 0"),
        (
            {"space": {RATE: {"low": -1.0, "high": 1e-3}}},
            "ppo.learning_rate is -1.0, but it should be greater than 0",
        ),
        ({"space": {RATE: {"low": 1e-3}}}, "give low and high, or choices"),
        ({"space": {RATE: {"choices": []}}}, "choices is empty"),
        ({"space": {RATE: {"choices": [0.1, 0.1]}}}, "choices names 0.1 twice"),
        ({"space": {RATE: {"choices": [0.1, "fast"]}}}, "ppo.learning_rate is 'fast', but"),
        ({"space": {RATE: {"choices": [0.1], "log": True}}}, "choices go without"),
        ({"space": {RATE: {"lo": 0.1, "high": 0.2}}}, "space.ppo.learning_rate.lo"),
        (
            {"space": {"ppo.epochs": {"low": 1.5, "high": 3}}},
            "low = 1.5, but ppo.epochs holds whole numbers",
        ),
        ({"space": {"ppo.mirror": {"low": 0, "high": 1}}}, "ppo.mirror is no single number"),
        ({"space": {"network.hidden": {"choices": [[16], [0]]}}}, "network.hidden"),
        ({"space": {"seed": {"choices": [1, 2]}}}, "training seeds are listed under seeds"),
        ({"space": {"held_out.starts": {"low": 1, "high": 9}}}, "belongs to what measures"),
        (
            {"space": {RATE: LINEAR | {"only_when": {"ppo.mirror": True}}}},
            "ppo.mirror does not stand above",
        ),
        (
            {
                "space": {
                    "ppo.mirror": {"choices": [True]},
                    RATE: LINEAR | {"only_when": {"ppo.mirror": False}},
                }
            },
            "ppo.mirror is never False",
        ),
        ({"set": {"ppo.stepz": 3}}, "set: there is no ppo.stepz"),
        ({"set": {"ppo.steps": -3}}, "ppo.steps is -3"),
        (
            {"objectives": [{"measure": "speed"}]},
            "objectives.0.measure is 'speed', but it should be one of 'held_out', ",
        ),
        ({"objectives": [{"success": 0.5}]}, "objectives.0.measure is missing"),
        ({"objectives": [{"measure": "exact", "suites": []}]}, "should hold at least 1"),
        ({"objectives": []}, "objectives is empty"),
        (
            {"objectives": [{"measure": "held_out"}, {"measure": "held_out"}]},
            "objectives measures held_out twice",
        ),
        ({"objectives": [{"measure": "steps_to_success", "success": 1.5}]}, "success is 1.5"),
        ({"objectives": [{"measure": "exact", "suites": ["stairs"]}]}, "objectives.0"),
        (
            {"objectives": [{"measure": "exact", "parameters": {"sample": 3}}]},
            "has no setting sample;",
        ),
        (
            {
                "pruner": "median",
                "objectives": [{"measure": "held_out"}, {"measure": "steps_to_success"}],
            },
            "pruner = median needs a single objective",
        ),
        ({"seeds": [0, 1, 0]}, "seeds names 0 twice"),
        ({"seeds": []}, "seeds is empty"),
        ({"trials": 0}, "trials is 0"),
        ({"vectorised": True, "pruner": "median"}, "vectorised is true, but pruner = median"),
        (
            {"vectorised": True, "space": {"ppo.epochs": {"low": 1, "high": 3}}},
            "space.ppo.epochs is another program",
        ),
        ({"vectorised": True, "objectives": [{"measure": "seconds_to_success"}]}, "train alone"),
        ({"config": "nothing.yaml"}, "nothing.yaml does not exist"),
    ],
)
def test_what_a_sweep_cannot_mean_is_refused(tmp_path, changes, said):
    path = write_sweep(tmp_path, **changes)
    with pytest.raises(InputError) as refusal:
        open_sweep(path)
    assert said in str(refusal.value)
    assert "\n" not in str(refusal.value)
    assert "nothing" in said or str(path) in str(refusal.value)


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"vary": {"ppo.epochs": {"low": 1, "high": 3}}}, "vary.ppo.epochs is another program"),
        ({"vary": {"ppo.clp": LINEAR}}, "vary: there is no ppo.clp; perhaps you meant ppo.clip"),
        ({"vary": {"ppo.clip": {"low": -1.0, "high": 0.2}}}, "ppo.clip is -1.0"),
        ({"vary": {"ppo.clip": LINEAR | {"only_when": {"ppo.entropy": 1}}}}, "only_when"),
        ({"seeds": [3, 3]}, "seeds names 3 twice, and nothing varies"),
        ({"evolution": {}}, "evolution needs numbers to try"),
        ({"seeds": [0], "vary": {"ppo.clip": LINEAR}, "evolution": {}}, "at least two members"),
        ({"vary": {"ppo.clip": LINEAR}, "evolution": {"share": 0.6}}, "evolution.share is 0.6"),
    ],
)
def test_what_a_population_cannot_mean_is_refused(tmp_path, changes, said):
    path = write_population(tmp_path, **changes)
    with pytest.raises(InputError) as refusal:
        open_population(path)
    assert said in str(refusal.value)
    assert str(path) in str(refusal.value)


def test_values_that_fit_only_together_are_let_through(tmp_path):
    """64 robots in 3 minibatches never fit; 96 in 3 do: no border can know before the draw."""
    space = {
        "ppo.environments": {"choices": [64, 96]},
        "ppo.minibatches": {"choices": [2, 3]},
    }
    sweep = open_sweep(write_sweep(tmp_path, space=space))
    assert sweep.run_config({"ppo.environments": 96, "ppo.minibatches": 3}, 0).ppo.minibatches == 3
    with pytest.raises(InputError, match="minibatches = 3 does not divide"):
        sweep.run_config({"ppo.environments": 64, "ppo.minibatches": 3}, 0)


def test_vectorised_is_chosen_where_it_can_be(tmp_path):
    assert open_sweep(write_sweep(tmp_path)).vectorised
    assert not open_sweep(write_sweep(tmp_path, pruner="median")).vectorised
    assert not open_sweep(write_sweep(tmp_path, vectorised=False)).vectorised
    space = {"ppo.epochs": {"low": 1, "high": 3}}
    assert not open_sweep(write_sweep(tmp_path, space=space)).vectorised


def test_the_examples_can_run():
    assert not open_sweep(ROOT / "examples/sweep.yaml").vectorised
    assert len(open_population(ROOT / "examples/population.yaml").configs) == 8


def test_the_command_says_one_sentence_and_leaves_nothing(tmp_path):
    path = write_sweep(tmp_path, space={"ppo.learning_rte": LINEAR})
    done = subprocess.run(
        [sys.executable, "-m", "jaxleas.cli", "sweep", str(path), "--out", str(tmp_path / "out")],
        capture_output=True,
        text=True,
        cwd=ROOT,
        check=False,
    )
    assert done.returncode == 2
    assert done.stderr.count("\n") == 1
    assert "perhaps you meant ppo.learning_rate" in done.stderr
    assert not (tmp_path / "out").exists()
