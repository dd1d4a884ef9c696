"""Robots that stand with their feet at given places: the angles of their joints."""

import numpy as np
from jaxtyping import Float

from jaxleas.controllers.legs import LegKinematics
from jaxleas.physics import Body, BodyState
from jaxleas.physics import standing as standing_state
from jaxleas.types import matrix_of

ROUNDS = 60
FIRM = 1e-4
"""What is added to the squared Jacobians, so that a stretched leg takes small steps [m2]."""


def standing_with(
    body: Body,
    com: Float[np.ndarray, "N 3"],
    yaw: Float[np.ndarray, " N"],
    feet: Float[np.ndarray, "N E 3"],
) -> tuple[BodyState, Float[np.ndarray, "N E"]]:
    """Return robots at rest, and how far each foot is from its place [m].

    Args:
        body: robot.
        com: places of the centre of mass, which is taken to be where it is when standing [m].
        yaw: headings [rad].
        feet: places of the middles of the feet [m].
    """
    state = standing_state(body, com, yaw)
    rotation = matrix_of(state.quaternion)
    state.coordinates[:, :3] = com - rotation @ body.com
    wanted = (feet - state.position[:, None]) @ rotation
    legs = LegKinematics(body)
    angles = state.angles.copy()
    for _ in range(ROUNDS):
        posture = legs.posture(angles)
        error = wanted - posture.feet
        turned = np.swapaxes(posture.jacobians, -1, -2)
        square = turned @ posture.jacobians + FIRM * np.eye(turned.shape[-2])
        step = np.linalg.solve(square, turned @ error[..., None])[..., 0]
        angles = angles + step.reshape(angles.shape).clip(-0.3, 0.3)
    state.coordinates[:, 7:] = angles
    return state, np.linalg.norm(wanted - legs.posture(angles).feet, axis=-1)
