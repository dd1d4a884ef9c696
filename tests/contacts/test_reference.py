"""Verdicts from outside: exact MIPs by other solvers, and the published SL1M code."""

import numpy as np
import pytest

from jaxleas.contacts import plan_astar
from jaxleas.contacts.certificate import certify
from jaxleas.contacts.programs.mip import plan_mip
from jaxleas.contacts.programs.sl1m import plan_sl1m
from tests.contacts.worlds import reference_entries, reference_problem

MODELS = ["two_com", "feet"]


def check(shared, model: str, entries: list[dict], planner) -> dict[str, bool]:
    """Return which problems were solved, after comparing each verdict and certifying each plan."""
    solved = {}
    for entry in entries:
        verdict = entry["verdict"][model]
        if not verdict["robust"]:
            continue
        asked = reference_problem(shared, entry, model)
        plan = planner(asked, diagnose=False)
        solved[entry["id"]] = plan.feasible
        if plan.feasible:
            assert verdict["status"] == "feasible", f"{entry['id']}: a plan where there is none"
            assert certify(asked, plan).metres <= 1e-6
        elif plan.status == "infeasible":
            assert verdict["status"] == "infeasible", entry["id"]
        else:
            assert plan.status == "not_found"
    return solved


@pytest.mark.parametrize("planner", [plan_mip, plan_astar])
@pytest.mark.parametrize("model", MODELS)
def test_exact_planners_on_some(shared, model: str, planner) -> None:
    """Every infeasible problem, and every tenth feasible one."""
    entries = reference_entries(shared)
    infeasible = [e for e in entries if e["verdict"][model]["status"] == "infeasible"]
    feasible = [e for e in entries if e not in infeasible][::10]
    solved = check(shared, model, infeasible, planner)
    assert not any(solved.values())
    assert all(check(shared, model, feasible, planner).values())


@pytest.mark.parametrize("model", MODELS)
def test_sl1m_on_some(shared, model: str) -> None:
    entries = reference_entries(shared)[::12]
    assert np.mean(list(check(shared, model, entries, plan_sl1m).values())) > 0.5


@pytest.mark.slow
@pytest.mark.parametrize("planner", [plan_mip, plan_astar])
@pytest.mark.parametrize("model", MODELS)
def test_exact_planners_on_all(shared, model: str, planner) -> None:
    entries = reference_entries(shared)
    solved = check(shared, model, entries, planner)
    right = [
        solved[entry["id"]] == (entry["verdict"][model]["status"] == "feasible")
        for entry in entries
        if entry["id"] in solved
    ]
    assert len(right) == 145
    assert all(right)


@pytest.mark.slow
def test_sl1m_solves_what_the_published_code_did_and_more(shared) -> None:
    entries = reference_entries(shared)
    plan = lambda asked, **options: plan_sl1m(asked, time_limit=20.0, **options)  # noqa: E731
    late = lambda asked, **options: plan(asked, **options).but(status="not_found")  # noqa: E731
    solved = check(shared, "feet", entries, late)
    for entry in entries:
        said = entry["published_sl1m_feet"]
        published = said["success"] or said["l1_undecided"] == 0
        if published and entry["verdict"]["feet"]["status"] == "feasible":
            assert solved.get(entry["id"], True), entry["id"]
    feasible = [each for each in entries if each["verdict"]["feet"]["status"] == "feasible"]
    assert all(solved.get(entry["id"], True) for entry in feasible)
