"""A robot that stands as a gait plan begins, on the terrain that the plan is for."""

import numpy as np

from jaxleas.controllers import PhaseTracks, standing_with
from jaxleas.envs.gait_planning import FEET, in_contact
from jaxleas.gaits import GaitPlan
from jaxleas.physics import Body, BodyState
from jaxleas.terrain import Scene, ground_height
from jaxleas.types import InputError

APART = 0.02
"""Difference between the heights of a foothold and of the ground that is accepted [m]."""
OUT_OF_REACH = 0.01
"""Distance of a foot from its first foothold from which on the robot cannot stand there [m]."""


def start_of(
    plan: GaitPlan, tracks: PhaseTracks, body: Body, scene: Scene, named: str
) -> BodyState:
    """Return the robot at rest, with its feet on the plan's first footholds.

    Args:
        plan: plan.
        tracks: what a tracker follows of it.
        body: robot.
        scene: terrain.
        named: what the plan is called in messages.

    Raises:
        InputError: the robot has other feet, a foothold is not on the terrain's ground, or the
            robot cannot reach the first ones.
    """
    if body.feet != FEET:
        raise InputError(
            f"{named}: a plan of the feet {', '.join(FEET)}; the robot {body.name} has"
            f" {', '.join(body.feet)}"
        )
    _require_ground(plan, scene, named)
    com = tracks.at(np.zeros(1)).com
    start, apart = standing_with(body, com, tracks.yaws[:, 0], tracks.feet[:, 0])
    foot = int(apart[0].argmax())
    if apart[0, foot] > OUT_OF_REACH:
        raise InputError(
            f"{named}: the robot {body.name} cannot stand as the plan begins: its foot {FEET[foot]}"
            f" stays {100 * apart[0, foot]:.0f} cm from its place; the plan is for another robot"
        )
    return start


def _require_ground(plan: GaitPlan, scene: Scene, named: str) -> None:
    stands = in_contact(plan.phases.support)
    phases, feet = np.nonzero(stands)
    places = plan.phases.feet[stands].astype(np.float64)
    ground = ground_height(scene, places[:, :2])
    for phase, foot, place, height in zip(phases, feet, places, ground, strict=True):
        where = f"foot {FEET[foot]} of phase {phase} at ({place[0]:.2f}, {place[1]:.2f}) m"
        if np.isnan(height):
            raise InputError(f"{named}: no ground is under {where}: is it for another terrain?")
        if abs(height - place[2]) > APART:
            raise InputError(
                f"{named}: {where} is {100 * abs(place[2] - height):.0f} cm"
                f" {'above' if place[2] > height else 'below'} the ground: is it for another"
                " terrain?"
            )
