"""The limbs of a posture computed the slow way: one joint after the other."""

import math
from collections.abc import Collection

import numpy as np
from jaxtyping import Float
from scipy.spatial.transform import Rotation

from jaxleas.robots import Body, LimbModel, Robot
from jaxleas.types import InputError


def limb_of(robot: Robot, effector: str) -> LimbModel:
    """Return the joints, masses and shapes of the limb that carries an effector.

    Raises:
        InputError: the robot has no such effector, or its file has no 'model' of the limb.
    """
    limb = robot.limbs[robot.effector_index(effector)]
    if limb.model is None:
        raise InputError(
            f"the file of robot '{robot.name}' has no 'model' of its limb '{limb.name}', which"
            " postures need"
        )
    return limb.model


def body_of(robot: Robot) -> Body:
    """Return the mass of everything that is not a limb.

    Raises:
        InputError: the robot's file does not state it.
    """
    if robot.body is None:
        raise InputError(f"the file of robot '{robot.name}' has no 'body', which postures need")
    return robot.body


def resting_mass(robot: Robot, standing: Collection[str]) -> tuple[float, np.ndarray]:
    """Return mass [kg] and centre of mass [m] of all but the standing limbs, in the root frame.

    Limbs that do not stand and have a model, such as arms, are in their reference posture.

    Args:
        robot: robot with a body.
        standing: names of the effectors whose limbs are left out.

    Raises:
        InputError: the robot's file does not state the mass of its body.
    """
    body = body_of(robot)
    mass, com = body.mass, body.com
    for limb, effector in zip(robot.limbs, robot.effectors, strict=True):
        if effector.name in standing or limb.model is None:
            continue
        frames, origins, _, _ = chain(limb.model, limb.model.reference)
        for frame, origin, weight, place in zip(
            frames, origins, limb.model.link_mass, limb.model.link_com, strict=True
        ):
            if weight > 0.0:
                com = (mass * com + weight * (origin + frame @ place)) / (mass + weight)
                mass += float(weight)
    return mass, com


def chain(
    model: LimbModel, angles: Float[np.ndarray, " J"]
) -> tuple[list[np.ndarray], list[np.ndarray], np.ndarray, np.ndarray]:
    """Place a limb's links in the root frame, one joint after the other.

    Args:
        model: model of the limb.
        angles: joint angles [rad].

    Returns:
        Frames of the links, origins of their joints [m], position and rotation of the effector.
    """
    place, turn = np.zeros(3), np.eye(3)
    joints, frames, origins = model.chain, [], []
    for index, angle in enumerate(angles):
        place = place + turn @ joints.positions[index]
        origins.append(place)
        spin = Rotation.from_rotvec(float(angle) * joints.axes[index]).as_matrix()
        turn = turn @ joints.rotations[index] @ spin
        frames.append(turn)
    return frames, origins, place + turn @ joints.tip.position, turn @ joints.tip.rotation


def about(axis: str, angle: float) -> Float[np.ndarray, "3 3"]:
    """Return the rotation about a coordinate axis."""
    c, s = math.cos(angle), math.sin(angle)
    return {
        "x": np.array([[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]]),
        "y": np.array([[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]]),
        "z": np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]),
    }[axis]
