"""Robots that stand on terrain, and what is measured of them there."""

from collections.abc import Sequence

import numpy as np

from jaxleas.controllers import Walk
from jaxleas.crossing.course import Start
from jaxleas.footsteps import WalkingState, turned
from jaxleas.physics import Body, BodyState, make_physics, standing
from jaxleas.terrain import Scene, ground_height
from jaxleas.types import InputError

HANGS = 0.10
"""Height over the ground at which a foot that should stand hangs in the air, and the robot falls
[m]."""


def standing_on(scene: Scene, body: Body, starts: Sequence[Start]) -> BodyState:
    """Return robots that stand on a scene, each as high as the highest ground under its feet.

    Args:
        scene: terrain.
        body: robot.
        starts: x, y of the root [m] and heading [rad] of each robot.

    Raises:
        InputError: there is no ground under a foot, or it is far below that of the others.
    """
    level = standing(body, np.zeros((1, 3)))
    feet = make_physics(body, 1).step(level, np.zeros((1, len(body.joints)))).sensed.feet[0]
    places = []
    for x, y, yaw in starts:
        under = turned(feet[:, :2], np.full(len(feet), yaw)) + np.array([x, y])
        heights = ground_height(scene, under)
        for name, (foot_x, foot_y), height in zip(body.feet, under, heights, strict=True):
            place = f"foot {name} at ({foot_x:.2f}, {foot_y:.2f}) m"
            if np.isnan(height):
                raise InputError(f"the start ({x:g}, {y:g}): no ground under {place}")
            if np.nanmax(heights) - height > HANGS:
                raise InputError(
                    f"the start ({x:g}, {y:g}): the ground under {place} is"
                    f" {100 * (np.nanmax(heights) - height):.0f} cm below that of another foot, so"
                    f" that it would hang in the air; {100 * HANGS:g} cm are the most"
                )
        places.append((x, y, heights.max()))
    return standing(body, np.array(places), np.array([yaw for _, _, yaw in starts]))


def measured_at_start(walk: Walk, start: BodyState, pair: int = 0) -> WalkingState:
    """Return what is measured of the first of some robots that stand.

    Args:
        walk: controller in physics.
        start: robots that stand.
        pair: index of the pair that swings next.
    """
    sensed = walk.begin(start).sensed
    return WalkingState(
        com=sensed.com[0],
        yaw=float(sensed.yaw[0]),
        com_velocity=sensed.com_velocity[0],
        yaw_rate=float(sensed.turning_rate[0, 2]),
        feet=sensed.feet[0],
        pair=pair,
        command=np.zeros(3),
    )
