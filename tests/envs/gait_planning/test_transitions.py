"""Transitions that the task asks CROC, against a slow twin in loops, decided by HiGHS."""

import numpy as np
import pytest

from jaxleas.dynamics import (
    BoundaryState,
    Limits,
    Reach,
    Supports,
    Transitions,
    margins_by_definition,
)
from jaxleas.envs.gait_planning import candidate_of, command_of
from jaxleas.envs.gait_planning.supports import STANDING
from tests.envs.gait_planning.states import drawn_actions, drawn_states, make_task

COUNT, INSTANTS = 10, 4
NOMINAL = [(0.34, 0.2), (0.34, -0.2), (-0.34, 0.2), (-0.34, -0.2)]


def twin_of(phase, candidate, times, i: int) -> Transitions:
    """Return robot i's transition, with one row of reach for each side of each foot's own box."""
    durations = np.array([times[i, 1], times[i, 0]])
    switch = durations[0] / durations.sum()
    turn = (candidate.yaw[i] - phase.yaw[i] + np.pi) % (2 * np.pi) - np.pi
    rows, bounds = np.zeros((2, INSTANTS, 24, 3)), np.full((2, INSTANTS, 24), 50.0)
    feet, standing = np.zeros((2, 4, 3)), np.zeros((2, 4), bool)
    for s, (now, begin, end) in enumerate(((phase, 0.0, switch), (candidate, switch, 1.0))):
        feet[s], standing[s] = now.feet[i], STANDING[now.support[i]]
        for k, at in enumerate(np.linspace(begin, end, INSTANTS)):
            yaw = phase.yaw[i] + at * turn
            axes = np.array(
                [[np.cos(yaw), np.sin(yaw), 0], [-np.sin(yaw), np.cos(yaw), 0], [0, 0, 1]]
            )
            for foot, (x, y) in enumerate(NOMINAL):
                if not standing[s, foot]:
                    continue
                for axis, (middle, low, high) in enumerate(
                    ((x, -0.25, 0.25), (y, -0.12, 0.12), (-0.45, -0.03, 0.22))
                ):
                    at_foot = axes[axis] @ feet[s, foot] - middle
                    face = 6 * foot + 2 * axis
                    rows[s, k, face], bounds[s, k, face] = axes[axis], at_foot - low
                    rows[s, k, face + 1], bounds[s, k, face + 1] = -axes[axis], high - at_foot
    up = np.tile([0.0, 0.0, 1.0], (2, 4, 1))
    ahead = np.tile([1.0, 0.0, 0.0], (2, 4, 1))
    start, end = (
        BoundaryState(now.com[i].astype(float), np.append(now.velocity[i], 0.0), np.zeros(3))
        for now in (phase, candidate)
    )
    reach = Reach(rows, bounds)
    limits = Limits(0.5, 10.0, 1.17)
    supports = Supports(feet, up, ahead, standing)
    return Transitions(start, end, durations, supports, reach, limits)


@pytest.mark.slow
@pytest.mark.parametrize("published", [False, True])
def test_highs_confirms_every_verdict(published):
    pytest.importorskip("numba")
    task = make_task(contact_code="published" if published else "five_way")
    ground = task.make_world(range(12), False)
    state = drawn_states(task, ground, COUNT, seed=1)
    action = drawn_actions(COUNT, seed=2)
    if published:
        signs = np.random.default_rng(3).uniform(-1, 1, (COUNT, 3))
        action = np.concatenate([action[:, :-1], signs], axis=1)
    command = command_of(task.config, ground, state, action)
    candidate = candidate_of(task.config, ground, state, command)
    feasible, unknown = task.decide(state.phase, candidate, command.times, np.ones(COUNT, bool))
    assert not unknown.any()
    least = task.config.least_margin
    margins = [
        margins_by_definition(twin_of(state.phase, candidate, command.times, i)).item()
        for i in range(COUNT)
    ]
    assert ((np.array(margins) >= least) == feasible).all()
    assert 0 < feasible.sum() < COUNT
