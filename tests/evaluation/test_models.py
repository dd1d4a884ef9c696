"""Evaluations for a robot that has only one model of contact problems, which nobody has to name."""

from dataclasses import replace

import pytest

from jaxleas.evaluation import figures_command
from jaxleas.evaluation.figures_command import figures
from jaxleas.reports.commands import evaluate
from jaxleas.robots import write_robot
from jaxleas.training.policy import write_policy
from jaxleas.types import InputError
from tests.contacts.test_models import PLAIN, plain
from tests.evaluation.conftest import random_policy


@pytest.fixture
def policy(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    write_robot("robots/plain.json", plain())
    made = random_policy()
    config = made.config.model_copy(update={"robot": "plain"})
    write_policy(tmp_path / "policy.npz", replace(made, config=config))
    return tmp_path / "policy.npz"


def test_policies_of_such_a_robot_are_evaluated(policy, capsys) -> None:
    options = {"suite": "hole", "starts": 1, "methods": ["rb_kino"], "processes": 1}
    found = evaluate(policy, planners=["mip,sl1m"], parameters=["keep_every=9"], **options)
    for name in ("mip", "sl1m"):
        assert (found.planners[name]["model"], found.planners[name]["keep_every"]) == ("feet", 9)
    assert capsys.readouterr().out.count(PLAIN) == 1
    with pytest.raises(InputError, match="--parameters samples: none of the planners mip has"):
        evaluate(policy, planners=["mip"], parameters=["samples=9"], **options)
    with pytest.raises(InputError, match="say the same"):
        evaluate(policy, planners=["mip"], time_limit=1.0, parameters=["time_limit=9"], **options)


def test_figures_of_such_a_robot_are_measured(policy, capsys, monkeypatch) -> None:
    asked = []

    def measure(env, walkers, suite, questions, file, say):
        asked.append(questions.settings)
        return file.figures

    monkeypatch.setattr(figures_command, "measure_figures", measure)
    options = {"methods": ["rb_kino"], "processes": 1}
    figures(policy, out=policy.with_name("a.json"), **options)
    assert PLAIN in capsys.readouterr().out
    figures(
        policy, out=policy.with_name("b.json"), parameters=["model=feet", "window=0.7"], **options
    )
    assert PLAIN not in capsys.readouterr().out
    assert [(each.model, each.window) for each in asked] == [("feet", 0.8), ("feet", 0.7)]
    with pytest.raises(InputError, match="give the numbers to measure as --keep-every"):
        figures(policy, out=policy.with_name("c.json"), parameters=["keep_every=3"], **options)
    assert len(asked) == 2
