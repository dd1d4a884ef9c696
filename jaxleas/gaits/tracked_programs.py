"""Programs of a plan as a tracker asks them: balance counts, and legs reach a little farther."""

from dataclasses import replace
from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from jaxleas.dynamics import Discretisation, solve_transitions
from jaxleas.envs.gait_planning import (
    GaitPlanningConfig,
    Phases,
    QuadrupedConfig,
    transitions_of,
)
from jaxleas.gaits.gait_plan import GaitPlan

ROOM = 0.03
"""How much farther ahead and aside a leg reaches than the box that plans are made with [m]."""


class TrackedMargins(NamedTuple):
    """Largest margins [1], and the free points of their curves [m]."""

    margin: Float[np.ndarray, " N"]
    free_point: Float[np.ndarray, "N 3"]


def tracked_margins(
    plan: GaitPlan, before: Phases, after: Phases, times: Float[np.ndarray, "N 2"]
) -> TrackedMargins:
    """Return the margins of transitions of a plan's robot with more room to reach.

    A plan's margin is often that of reach: its box leaves the leg some way to go, where the trunk
    does not rise. With more room the margin is that of forces, which a tracker needs.

    Args:
        plan: plan whose robot and instants count.
        before: phases that transitions begin in.
        after: phases that they lead to.
        times: t_E* and t_S of each [s].
    """
    config = GaitPlanningConfig(robot=_roomier(plan.robot), instants=plan.program.instants)
    where = Discretisation(instants=plan.program.instants)
    origin = before.com.astype(np.float64)
    transitions = transitions_of(config, _from(before, origin), _from(after, origin), times)
    found = solve_transitions(transitions, where)
    return TrackedMargins(found.margin, found.free_point + origin)


def _from(phases: Phases, origin: Float[np.ndarray, "N 3"]) -> Phases:
    """Return phases with places from an origin: moments about a far one drown what is near."""
    feet = phases.feet - origin[:, None]
    return replace(phases, com=phases.com - origin, feet=feet)


def _roomier(robot: QuadrupedConfig) -> QuadrupedConfig:
    (x_low, y_low, z_low), (x_high, y_high, z_high) = robot.reach
    return robot.model_copy(
        update={
            "reach_low": (x_low - ROOM, y_low - ROOM, z_low),
            "reach_high": (x_high + ROOM, y_high + ROOM, z_high),
        }
    )
