"""Places for the centre of mass, against one linear program each by another solver."""

import numpy as np
import pytest
from scipy.optimize import linprog

from jaxleas.contacts.programs import com_places
from jaxleas.contacts.programs.com_places import FITS, place_coms
from jaxleas.contacts.programs.constraints import make_constraints, rotation
from tests.contacts.worlds import problem, random_world


def margin(step, number: int, displacement: np.ndarray) -> float:
    standing, landing = step.com[number]
    A = np.concatenate([standing.A, landing.A])
    b = np.concatenate([standing.b, landing.b + landing.A @ displacement])
    rows = np.column_stack([A, np.ones(len(b))])
    answer = linprog([0, 0, 0, -1], rows, b, bounds=[(None, None)] * 3 + [(None, 0.05)])
    assert answer.status == 0
    return float(answer.x[3])


def judged(seed: int):
    asked = problem(random_world(seed, "two_com"))
    steps = make_constraints(asked)
    rng = np.random.default_rng(seed)
    displacements = rng.uniform([-0.4, -0.4, -0.25], [0.4, 0.4, 0.25], (len(steps), 3))
    turns = np.broadcast_to(rotation(0.0), (len(steps), 2, 3, 3))
    half_sizes = np.broadcast_to(asked.half_sizes["LF"], (len(steps), 2, 2))
    return steps, displacements, *place_coms(steps, displacements, half_sizes, turns)


@pytest.mark.parametrize("alone", [True, False], ids=["small programs", "HiGHS"])
def test_places_are_found_where_there_are_some_and_refuted_where_not(monkeypatch, alone) -> None:
    if not alone:
        monkeypatch.setattr(com_places, "_exactly", lambda *_: None)
    counts = np.zeros(2, int)
    for seed in range(20):
        steps, displacements, places, cuts = judged(seed)
        for index, step in enumerate(steps):
            d = displacements[index]
            best = [margin(step, number, d) for number in (0, 1)]
            assert (index in cuts) == (min(best) < -FITS)
            counts[int(index in cuts)] += 1
            for normal, bound in cuts.get(index, []):
                assert normal @ d > bound + 0.5 * FITS, "the cut refutes this step"
            for number, (standing, landing) in enumerate(step.com):
                if best[number] >= 0.0:
                    c = places[index, number]
                    assert (standing.A @ c - standing.b).max() <= FITS
                    assert (landing.A @ (c - d) - landing.b).max() <= FITS
    assert counts.min() > 10


def test_a_cut_refutes_no_step_that_has_a_place() -> None:
    """Farkas: g . d <= h for every d for which some c fits."""
    found = 0
    for seed in range(5):
        steps, _, _, cuts = judged(seed)
        samples = np.random.default_rng(seed).uniform(-0.5, 0.5, (30, 3)) * [1, 1, 0.5]
        for index, each in cuts.items():
            for d in samples:
                if min(margin(steps[index], number, d) for number in (0, 1)) >= 0.0:
                    found += 1
                    assert all(normal @ d <= bound + 1e-9 for normal, bound in each)
    assert found > 50
