"""Plans made easier to track: the centre of mass rests where programs have larger margins."""

from dataclasses import replace

import numpy as np
from jaxtyping import Float

from jaxleas.envs.gait_planning import Phases
from jaxleas.gaits.gait import taken
from jaxleas.gaits.gait_plan import GaitPlan
from jaxleas.gaits.tracked_programs import tracked_margins

MOVES = 0.02 * np.stack(np.meshgrid([0, -1, 1], [0, -1, 1], indexing="ij"), axis=-1).reshape(-1, 2)
"""Moves of the centre of mass that are tried, none first [m]."""
ENOUGH = 0.12
"""Margin beyond which more is no better [1]: 12 % of the weight on each foot, 1.2 cm of reach."""


def eased(plan: GaitPlan, rounds: int = 4) -> GaitPlan:
    """Return a plan whose phases begin where the margins of their programs are larger.

    Feet, supports and times stay. In each round every second phase, then every other one, moves its
    centre of mass by at most 2 cm along each axis to where the smaller margin of the two
    transitions that meet there is largest. The first and the last phase stay.

    Args:
        plan: plan.
        rounds: number of rounds.
    """
    phases = plan.phases
    for number in range(2 * rounds):
        which = np.arange(1 + number % 2, plan.length, 2)
        if not len(which):
            continue
        rows, moves = np.repeat(which, len(MOVES)), np.tile(MOVES, (len(which), 1))
        middle = _moved(taken(phases, rows), moves)
        before, after = taken(phases, rows - 1), taken(phases, rows + 1)
        margin = np.minimum(
            tracked_margins(plan, before, middle, plan.times[rows - 1]).margin,
            tracked_margins(plan, middle, after, plan.times[rows]).margin,
        )
        best = np.minimum(margin, ENOUGH).reshape(len(which), -1).argmax(axis=1)
        com = phases.com.copy()
        com[which, :2] += MOVES[best].astype(np.float32)
        phases = replace(phases, com=com)
    return replace(plan, phases=phases)


def _moved(phases: Phases, moves: Float[np.ndarray, "N 2"]) -> Phases:
    com = phases.com.copy()
    com[:, :2] += moves
    return replace(phases, com=com)
