"""Members of one program are what they would be alone, and go on after any interruption."""

import functools
import json
from unittest.mock import patch

import jax
import numpy as np
import pytest

from jaxleas.configuration.values import with_values
from jaxleas.runs.folder import RunFolder
from jaxleas.sweeps import population_loop
from jaxleas.sweeps.config import Dimension
from jaxleas.sweeps.evolution import EvolutionConfig
from jaxleas.sweeps.history import read_history
from jaxleas.sweeps.population import Population, require_one_program
from jaxleas.sweeps.population_config import Members, open_population
from jaxleas.sweeps.population_folder import hold_population
from jaxleas.sweeps.population_loop import train_population
from jaxleas.training.loop import InterruptedRunError, train
from jaxleas.training.ppo_params import PpoParams, swept_fields
from jaxleas.types import InputError
from tests.sweeps.files import write_population
from tests.training.runs import tiny

OTHER = {
    "seed": 3,
    "ppo.learning_rate": 2e-3,
    "ppo.final_learning_rate": 1e-4,
    "ppo.discount": 0.97,
    "ppo.gae_lambda": 0.9,
    "ppo.clip": 0.17,
    "ppo.entropy": 0.01,
    "ppo.value_weight": 0.7,
    "ppo.reward_scale": 0.3,
    "ppo.max_gradient_norm": 0.6,
    "env.reward.final_failure": 33.3,
    "env.reward.direction": 2.0,
    "env.reward.orientation": 0.3,
    "env.reward.turn": 0.2,
    "env.reward.acceleration": 0.05,
    "env.reward.alive": 0.3,
    "env.reward.failure": 1.5,
}


# Everybody's members here: one compiled program does for all.
CONFIGS = (tiny(), with_values(tiny(), OTHER, "test"))


@pytest.fixture(scope="module", autouse=True)
def _compiled_once():
    with patch.object(population_loop, "Population", functools.cache(Population)):
        yield


def rows_of(run):
    rows = [json.loads(line) for line in (run / "metrics.jsonl").read_text().splitlines()]
    return [{name: value for name, value in row.items() if name != "seconds"} for row in rows]


def test_every_number_that_vectorises_is_in_the_pytree():
    """All of them differ from the default here, and each changes what `PpoParams` holds."""
    assert {*OTHER} == {*swept_fields(tiny().env), "seed"}
    plain = jax.tree.leaves(PpoParams.of(tiny()))
    for name in swept_fields(tiny().env):
        changed = jax.tree.leaves(PpoParams.of(with_values(tiny(), {name: OTHER[name]}, "test")))
        assert any(float(a) != float(b) for a, b in zip(plain, changed, strict=True)), name


def test_members_of_other_programs_are_refused():
    other = with_values(tiny(), {"ppo.epochs": 3}, "test")
    with pytest.raises(InputError, match=r"members 0 and 1 differ in ppo.epochs \(2 and 3\)"):
        require_one_program([tiny(), other])
    assert require_one_program([tiny(), with_values(tiny(), OTHER, "test")]) == tiny()


def test_a_populations_folder_is_one_populations(tmp_path):
    members = open_population(write_population(tmp_path))
    others = open_population(write_population(tmp_path, seeds=[0, 2]))
    out = tmp_path / "out"
    with (
        hold_population(out, members) as runs,
        pytest.raises(InputError, match="is in use by"),
        hold_population(out, members),
    ):
        pass
    assert [run.name for run in runs] == ["member_00", "member_01"]
    with pytest.raises(InputError, match="holds another population"), hold_population(out, others):
        pass
    with pytest.raises(InputError, match="is no population"), hold_population(tmp_path, members):
        pass


@pytest.mark.slow
@pytest.mark.usefixtures("brax_ranks")
def test_a_member_is_what_it_would_be_alone(tmp_path):
    runs = [tmp_path / "member_00", tmp_path / "member_01"]
    train_population(Members(CONFIGS, ({}, {})), runs, tmp_path)
    with RunFolder.create(tmp_path / "alone", "seed: 3\n", ["test"]) as run:
        train(CONFIGS[1], run)
    mine, alone = rows_of(runs[1]), rows_of(tmp_path / "alone")
    assert [row.keys() for row in mine] == [row.keys() for row in alone]
    for name in alone[0]:  # the first two updates: later ones magnify rounding
        for row in range(2):
            np.testing.assert_allclose(mine[row][name], alone[row][name], rtol=1e-4, atol=1e-5)
    with np.load(runs[1] / "policy.npz") as one, np.load(tmp_path / "alone/policy.npz") as other:
        assert one.files == other.files
        assert str(one["metadata"]) == str(other["metadata"])
        for name in one.files:
            if name != "metadata":
                np.testing.assert_allclose(one[name], other[name], rtol=1e-3, atol=1e-4)


@pytest.mark.slow
@pytest.mark.usefixtures("brax_ranks")
def test_an_interrupted_evolution_goes_on_as_if_it_had_not_been(tmp_path, monkeypatch):
    space = {"ppo.learning_rate": Dimension(low=1e-4, high=1e-2, log=True)}
    values = tuple({"ppo.learning_rate": each.ppo.learning_rate} for each in CONFIGS)
    members = Members(CONFIGS, values, space, EvolutionConfig(every=1), seed=5)
    whole, cut = tmp_path / "whole", tmp_path / "cut"
    first = train_population(members, [whole / f"m{n}" for n in range(2)], whole)
    rounds = read_history(whole / "history.jsonl")
    assert [row.step for row in rounds] == [640 * n for n in (2, 4, 6)]
    assert all(row.parents in ([0, 0], [1, 1]) for row in rounds)

    calls = iter(range(100))
    monkeypatch.setattr(
        "jaxleas.runs.interruption.Interruption.requested",
        property(lambda self: next(calls) >= 4, lambda self, value: None),
        raising=False,
    )
    with pytest.raises(InterruptedRunError, match="the same command resumes"):
        train_population(members, [cut / f"m{n}" for n in range(2)], cut)
    monkeypatch.undo()
    again = train_population(members, [cut / f"m{n}" for n in range(2)], cut)
    assert read_history(cut / "history.jsonl") == rounds
    assert [(each.best, each.values) for each in first] == [
        (each.best, each.values) for each in again
    ]
    for number in range(2):
        assert rows_of(whole / f"m{number}") == rows_of(cut / f"m{number}")
