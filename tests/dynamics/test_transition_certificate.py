"""Solutions of transitions, rebuilt by code that did not produce them."""

import pytest

from jaxleas.dynamics import Discretisation, certify_transition, one_of, solve_transitions
from tests.dynamics.transitions import random_transitions

INSTANTS = Discretisation()


@pytest.fixture(scope="module")
def solved():
    transitions = random_transitions(24, seed=1)
    return transitions, solve_transitions(transitions, INSTANTS, "jax")


def best(solved) -> int:
    return int(solved[1].margin.argmax())


def certified(solved, index, free_point=None, forces=None):
    transitions, found = solved
    return certify_transition(
        one_of(transitions, index),
        INSTANTS,
        found.free_point[index] if free_point is None else free_point,
        found.forces[index] if forces is None else forces,
    )


def test_forces_balance_and_stay_within_their_limits(solved):
    index = best(solved)
    found = certified(solved, index)
    assert found.imbalance < 1e-6
    assert found.outside == 0.0
    # Both ends of both phases are among the instants that the program knew.
    assert found.margin <= solved[1].margin[index] + 1e-5


def test_a_shifted_curve_or_a_changed_force_is_found(solved):
    index = best(solved)
    shifted = certified(solved, index, free_point=solved[1].free_point[index] + [0.0, 0.3, 0.0])
    assert shifted.margin < 0.0
    assert shifted.imbalance > 1e-2
    forces = solved[1].forces[index].copy()
    forces[0, 0, 0, 0] += 1.0
    changed = certified(solved, index, forces=forces)
    assert changed.imbalance > 0.5
    assert changed.outside > 0.1


def test_the_weakest_is_named_with_its_instant(solved):
    transitions, found = solved
    index = int(found.margin.argmin())
    certificate = certified(solved, index)
    name, time = certificate.weakest
    assert name in ("force", "reach", "acceleration")
    assert 0.0 <= time <= float(transitions.durations[index].sum())
    assert certificate.margin < 0.0


@pytest.mark.slow
@pytest.mark.parametrize("solver", ["jax", "compiled"])
def test_what_holds_at_control_points_holds_at_fifty_instants(solver):
    if solver == "compiled":
        pytest.importorskip("numba")
    transitions = random_transitions(24, seed=2)
    where = Discretisation(kind="everywhere")
    found = solve_transitions(transitions, where, solver)
    assert found.feasible().any()
    for index in range(len(found.margin)):
        certificate = certify_transition(
            one_of(transitions, index), where, found.free_point[index], found.forces[index]
        )
        assert certificate.margin >= found.margin[index] - 1e-5
        assert certificate.imbalance < 1e-5
        assert found.margin[index] < 0.0 or certificate.outside < 1e-6
