"""Combinations come cheapest first, each once, and those that a failure rules out never."""

import itertools

import numpy as np
import pytest

from jaxleas.contacts.programs.attempt import DECIDED, attempt
from jaxleas.contacts.programs.combinations import Combinations
from jaxleas.contacts.programs.constraints import make_constraints
from jaxleas.contacts.programs.placement import place
from tests.contacts.worlds import (
    problem,
    random_world,
    reference_entries,
    reference_problem,
)

NAMES = [("a", "b", "c"), ("d",), ("e", "f"), ("g", "h", "i")]
SLACK = (
    np.array([0.2, 0.0, 0.3]),
    np.array([0.0]),
    np.array([0.1, 0.4]),
    np.array([0.0, 0.2, 0.9]),
)


def cost(chosen: tuple[str, ...]) -> float:
    return sum(s[n.index(c)] for c, n, s in zip(chosen, NAMES, SLACK, strict=True))


def test_all_of_them_cheapest_first() -> None:
    combinations = Combinations(NAMES, SLACK)
    found = list(combinations)
    assert found[0] == ("b", "d", "e", "g")
    assert sorted(found) == sorted(itertools.product(*NAMES))
    costs = [cost(each) for each in found]
    assert (np.diff(costs) > -1e-12).all()
    assert combinations.exhausted


@pytest.mark.parametrize("seed", range(20))
def test_only_what_is_ruled_out_is_passed_over(seed: int) -> None:
    """Whatever pairs and triples are impossible, the cheapest possible combination is found."""
    rng = np.random.default_rng(seed)
    bad = []
    for _ in range(12):
        phases = tuple(sorted(rng.choice(4, size=rng.integers(1, 4), replace=False).tolist()))
        bad.append(
            (phases, tuple(NAMES[phase][rng.integers(len(NAMES[phase]))] for phase in phases))
        )
    fails = lambda each: next((p for p, n in bad if tuple(each[k] for k in p) == n), None)  # noqa: E731
    possible = [each for each in itertools.product(*NAMES) if fails(each) is None]
    combinations, tried, found = Combinations(NAMES, SLACK), 0, None
    for each in combinations:
        tried += 1
        blamed = fails(each)
        if blamed is None:
            found = each
            break
        combinations.refute(blamed)
    assert tried <= len(bad) + 1, "each failure teaches something new"
    assert (found is None) == (not possible)
    assert found is None or cost(found) == pytest.approx(min(map(cost, possible)))
    assert combinations.exhausted == (found is None)


@pytest.mark.parametrize("model", ["two_com", "feet"])
def test_those_to_blame_are_impossible_whatever_the_others_do(model: str) -> None:
    blamed_less = 0
    for seed in range(5):
        asked = problem(random_world(seed, model))
        steps = make_constraints(asked)
        for chosen in itertools.product(*(phase.candidates for phase in asked.steps)):
            placed = place(asked, steps, chosen)
            if placed.status == "optimal":
                continue
            assert placed.blamed
            blamed_less += len(placed.blamed) < len(asked)
            for other in itertools.product(*(phase.candidates for phase in asked.steps)):
                if all(other[k] == chosen[k] for k in placed.blamed):
                    assert place(asked, steps, other).status == "infeasible"
            break
    assert blamed_less >= 2, "blaming everybody teaches nothing"


def test_a_decision_that_failed_is_taken_back(shared) -> None:
    """On this one the decided phases alone have no plan, but there is one."""
    (entry,) = [e for e in reference_entries(shared) if e["id"] == "hppenv_rubbles_4_25"]
    asked = reference_problem(shared, entry, "two_com")
    found = attempt(asked)
    assert found.status == "optimal"
    assert found.combinations > 1
    taken_back = 0
    for phase, point, chosen in zip(
        asked.steps, found.relaxed.footholds, found.surfaces, strict=True
    ):
        distance = {name: float(asked.surfaces[name].distance(point)) for name in phase.candidates}
        taken_back += min(distance.values()) <= DECIDED < distance[chosen]
    assert taken_back >= 1
