"""Margins of contact transitions against their definition, solved by HiGHS, and by laws."""

import json
import os
import subprocess
import sys

import jax
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from jaxleas.dynamics import (
    LEAST_MARGIN,
    BoundaryState,
    Discretisation,
    Ended,
    Limits,
    Reach,
    Transitions,
    assemble,
    decide_transitions,
    margins_by_definition,
    solve_in_jax,
    solve_transitions,
)
from jaxleas.types import InputError
from tests.dynamics.transitions import moved, random_transitions, some_of

COUNT = 24
KNOWN = 2e-5  # accuracy of a margin, as `Solutions` states it, twice
SOLVERS = ["jax", pytest.param("compiled", marks=pytest.mark.slow)]
EVERYWHERE = Discretisation(kind="everywhere", pieces=2)


@pytest.fixture(scope="module")
def transitions() -> Transitions:
    return random_transitions(COUNT, seed=1)


@pytest.fixture(params=SOLVERS)
def solver(request: pytest.FixtureRequest) -> str:
    if request.param == "compiled":
        pytest.importorskip("numba")
    return request.param


def margins(transitions: Transitions, solver: str = "jax") -> np.ndarray:
    found = solve_transitions(transitions, None, solver)
    assert (found.ended == Ended.CONVERGED).all()
    return found.margin


def test_agrees_with_the_definition(transitions, solver):
    found = margins(transitions, solver)
    np.testing.assert_allclose(found, margins_by_definition(transitions), atol=KNOWN)
    assert (found > 1e-3).any()
    assert (found < -1e-3).any()


@pytest.mark.slow
@pytest.mark.parametrize(
    ("solver", "where"),
    [
        ("compiled", EVERYWHERE),
        ("compiled", Discretisation(degree=6, instants=3)),
        ("compiled", Discretisation(degree=6, kind="everywhere")),
        ("compiled", Discretisation(instants=2, generators=6)),
        # Each is a program of its own for XLA, which takes longer to compile than all the rest.
        ("jax", EVERYWHERE),
        ("jax", Discretisation(degree=6, instants=3)),
    ],
)
def test_agrees_with_the_definition_wherever_it_is_checked(transitions, solver, where):
    if solver == "compiled":
        pytest.importorskip("numba")
    found = solve_transitions(transitions, where, solver)
    assert (found.ended == Ended.CONVERGED).all()
    np.testing.assert_allclose(found.margin, margins_by_definition(transitions, where), atol=KNOWN)


def test_the_compiled_loops_are_right_before_they_are_compiled():
    """The same code, run by Python: what compilation adds is tested where there is time for it."""
    pytest.importorskip("numba")
    code = (
        "import json\n"
        "from jaxleas.dynamics import decide_transitions, solve_transitions\n"
        "from tests.dynamics.transitions import random_transitions\n"
        "found = solve_transitions(random_transitions(3, seed=1), None, 'compiled')\n"
        "decided = decide_transitions(random_transitions(3, seed=1), 1e-3, None, 'compiled')\n"
        "answers = [found.margin, found.ended, decided.feasible(), decided.ended]\n"
        "print(json.dumps([each.tolist() for each in answers]))\n"
    )
    answer = subprocess.run(
        [sys.executable, "-c", code],
        env={**os.environ, "NUMBA_DISABLE_JIT": "1"},
        capture_output=True,
        text=True,
        timeout=300,
    )
    assert answer.returncode == 0, answer.stderr
    found, ended, feasible, decided = json.loads(answer.stdout.splitlines()[-1])
    assert ended == [Ended.CONVERGED] * 3
    assert feasible == [margin >= LEAST_MARGIN for margin in found]
    assert decided == [Ended.DECIDED] * 3
    expected = margins_by_definition(random_transitions(3, seed=1))
    np.testing.assert_allclose(found, expected, atol=KNOWN)


@pytest.mark.slow
@pytest.mark.parametrize("least", [-0.2, LEAST_MARGIN, 0.1])
def test_a_search_that_stops_at_its_proof_says_the_same(least):
    pytest.importorskip("numba")
    many = random_transitions(400, seed=5)
    whole = solve_transitions(many, None, "compiled")
    decided = decide_transitions(many, least, None, "compiled")
    known = (whole.ended == Ended.CONVERGED) & (np.abs(whole.margin - least) > KNOWN)
    assert known.mean() > 0.98
    assert (decided.feasible(least) == whole.feasible(least))[known].all()
    stopped = decided.ended == Ended.DECIDED
    assert stopped.mean() > 0.5
    assert decided.iterations.mean() < 0.8 * whole.iterations.mean()
    # What is accepted reaches its margin; what is refused has a larger one somewhere below.
    assert (decided.margin <= whole.margin + KNOWN)[stopped & known].all()


def test_more_instants_never_help(transitions):
    """Seven instants hold the four; control points hold at every instant."""
    few = margins_by_definition(some_of(transitions, slice(0, 4)))
    many = margins_by_definition(some_of(transitions, slice(0, 4)), Discretisation(instants=7))
    always = margins_by_definition(some_of(transitions, slice(0, 4)), EVERYWHERE)
    assert (many <= few + 1e-9).all()
    assert (always <= many + 1e-9).all()


def test_blind_to_where_the_world_begins(transitions):
    there = moved(transitions, np.eye(3), np.array([40.0, -30.0, 5.0]))
    np.testing.assert_allclose(margins(there), margins(transitions), atol=KNOWN)


def test_turns_with_the_robot(transitions):
    # The bound on the acceleration is a box along the world's axes: here nothing comes near it.
    free = transitions._replace(limits=Limits(0.5, 1000.0, 1.17))
    turned = moved(free, Rotation.from_euler("z", 0.7).as_matrix(), np.zeros(3))
    np.testing.assert_allclose(margins(turned), margins(free), atol=KNOWN)


def test_the_same_in_a_mirror(transitions):
    mirrored = moved(transitions, np.diag([1.0, -1.0, 1.0]), np.zeros(3))
    np.testing.assert_allclose(margins(mirrored), margins(transitions), atol=KNOWN)


def test_backwards_in_time(transitions):
    """Played backwards, velocities change sign and accelerations do not."""

    def reversed_state(state: BoundaryState) -> BoundaryState:
        return BoundaryState(state.com, -state.velocity, state.acceleration)

    back = transitions._replace(
        start=reversed_state(transitions.end),
        end=reversed_state(transitions.start),
        durations=transitions.durations[:, ::-1],
        supports=jax.tree.map(lambda each: each[:, ::-1], transitions.supports),
        reach=jax.tree.map(lambda each: each[:, ::-1], transitions.reach),
    )
    np.testing.assert_allclose(margins(back), margins(transitions), atol=KNOWN)


def test_lengths_and_times_scaled_together(transitions):
    """Lengths times k and times times root k leave accelerations, and so the slack of forces."""
    scale = 2.25
    free = transitions._replace(
        reach=Reach(0.0 * transitions.reach.rows, 10.0 + 0.0 * transitions.reach.bounds)
    )
    larger = moved(free, scale * np.eye(3), np.zeros(3))
    supports = free.supports._replace(points=scale * free.supports.points)
    grown = larger._replace(
        start=BoundaryState(
            *(a * b for a, b in zip(free.start, (scale, scale**0.5, 1.0), strict=True))
        ),
        end=BoundaryState(
            *(a * b for a, b in zip(free.end, (scale, scale**0.5, 1.0), strict=True))
        ),
        durations=free.durations * scale**0.5,
        supports=supports,
        reach=free.reach,
    )
    np.testing.assert_allclose(margins(grown), margins(free), atol=KNOWN)


@pytest.mark.parametrize("change", ["friction", "reach", "force"])
def test_more_of_anything_never_hurts(transitions, change):
    better = {
        "friction": transitions._replace(limits=Limits(0.7, 10.0, 1.17)),
        "force": transitions,  # than with half the weight on a foot at most
        "reach": transitions._replace(
            reach=Reach(transitions.reach.rows, transitions.reach.bounds + 0.02)
        ),
    }[change]
    fewer = (
        transitions._replace(limits=Limits(0.5, 10.0, 0.5)) if change == "force" else transitions
    )
    found = solve_transitions(fewer, None, "jax")
    before, known = found.margin, found.ended == Ended.CONVERGED
    gain = margins(better) - before
    # A wider pyramid also moves its faces away from forces that pull: only feasible margins grow.
    counts = known & (before >= 0.0) if change == "friction" else known
    assert counts.any()
    assert (gain[counts] >= -KNOWN).all()
    assert (gain > 1e-3).any()


def test_two_feet_at_one_place_and_a_foot_twice(transitions):
    together = some_of(transitions, slice(0, COUNT))
    points = together.supports.points.copy()
    points[:, :, 1] = points[:, :, 0]
    together = together._replace(supports=together.supports._replace(points=points))
    found = solve_transitions(together, None, "jax")
    alone = found.ended == Ended.UNSUPPORTED  # three feet of which two are one stand on a line
    assert alone.any()
    assert not alone.all()
    assert (found.margin[alone] == -np.inf).all()
    expected = margins_by_definition(some_of(together, slice(0, COUNT)))
    known = found.ended == Ended.CONVERGED
    assert (known | alone).all()
    np.testing.assert_allclose(found.margin[known], expected[known], atol=KNOWN)


def test_a_robot_on_nothing_has_no_margin(transitions, solver):
    standing = transitions.supports.standing.copy()
    standing[:, 1] = False
    found = solve_transitions(
        transitions._replace(supports=transitions.supports._replace(standing=standing)),
        None,
        solver,
    )
    assert (found.ended == Ended.UNSUPPORTED).all()
    assert (found.margin == -np.inf).all()
    assert not found.feasible(-np.inf).any()


@pytest.mark.parametrize("duration", [1e-12, 1e-6, 1e-3, 1e4, 1e9])
def test_no_feasible_verdict_from_absurd_durations(transitions, duration):
    """In no time the robot would have to jump; in ages it drifts off at its first velocity."""
    durations = np.full_like(transitions.durations, duration)
    found = solve_transitions(transitions._replace(durations=durations), None, "jax")
    assert not found.feasible().any()


@pytest.mark.slow  # compiles once more
def test_one_program_alone_and_any_batch_shape(transitions):
    with jax.enable_x64(True):
        programs = jax.tree.map(jax.numpy.asarray, assemble(transitions, Discretisation()))
        folded = jax.tree.map(lambda each: each.reshape(4, 6, *each.shape[1:]), programs)
        found = jax.jit(jax.vmap(solve_in_jax))(folded)
        assert found.margin.shape == (4, 6)
        np.testing.assert_allclose(
            np.asarray(found.margin).reshape(-1), margins(transitions), atol=KNOWN
        )


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        ({"durations": np.zeros((COUNT, 2))}, "durations must be positive"),
        ({"durations": np.ones((COUNT, 3))}, "has shape"),
        ({"limits": Limits(-0.5)}, "the limit friction is"),
        ({"limits": Limits(0.5, np.nan)}, "the limit acceleration is"),
    ],
)
def test_bad_input_is_one_sentence(transitions, change, sentence):
    with pytest.raises(InputError, match=sentence):
        solve_transitions(transitions._replace(**change))


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        ({"degree": 5}, "degree 5 is not built"),
        ({"kind": "some"}, "give 'instants' or 'everywhere'"),
        ({"instants": 1}, "give 2 or more"),
        ({"pieces": 0}, "give 1 or more"),
        ({"generators": 2}, "needs 3 generators or more"),
    ],
)
def test_discretisations_that_are_none_are_refused(change, sentence):
    with pytest.raises(InputError, match=sentence):
        Discretisation(**change)


def test_normals_must_be_unit_and_reach_at_the_right_instants(transitions):
    supports = transitions.supports
    long = transitions._replace(supports=supports._replace(normals=2.0 * supports.normals))
    with pytest.raises(InputError, match="length 1"):
        solve_transitions(long)
    rows, bounds = (np.repeat(each, 3, axis=2) for each in transitions.reach)
    with pytest.raises(InputError, match="3 instants of each phase: give 1, or the 4"):
        solve_transitions(transitions._replace(reach=Reach(rows, bounds)))


@pytest.mark.slow  # compiles once more
def test_reach_given_at_each_instant_means_the_same(transitions):
    rows, bounds = (np.repeat(each, 4, axis=2) for each in transitions.reach)
    each = transitions._replace(reach=Reach(rows, bounds))
    np.testing.assert_allclose(margins(each), margins(transitions), atol=KNOWN)
    np.testing.assert_allclose(
        margins_by_definition(some_of(each, slice(0, 3))), margins(each)[:3], atol=KNOWN
    )
