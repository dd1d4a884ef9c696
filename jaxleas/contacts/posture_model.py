"""One posture computed the slow way: legs joint by joint, soles corner by corner."""

import math
from collections.abc import Collection
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float
from scipy.spatial.transform import Rotation

from jaxleas.contacts.posture import Posture
from jaxleas.robots import Body, LimbModel, Robot
from jaxleas.terrain import Scene
from jaxleas.types import InputError


@dataclass(frozen=True, eq=False)
class Stood:
    """A computed posture.

    Attributes:
        found: violation of each constraint on feet and legs [m], with the constraint's name.
        rotations: rotations of the feet in the world.
        soles: middle of each sole in the world [m].
        corners: corners of the part of each sole that is over its surface [m].
        com: centre of mass of the whole robot in the world [m].
        mass: mass of the whole robot [kg].
    """

    found: list[tuple[float, str]]
    rotations: dict[str, Float[np.ndarray, "3 3"]]
    soles: dict[str, Float[np.ndarray, " 3"]]
    corners: dict[str, Float[np.ndarray, "C 3"]]
    com: Float[np.ndarray, " 3"]
    mass: float


def stand(
    posture: Posture,
    root: Float[np.ndarray, " 3"],
    yaw: float,
    gap: float,
    scene: Scene,
    robot: Robot,
) -> Stood:
    """Compute a posture.

    Args:
        posture: posture of a sampling plan.
        root: position of the root at the guide's configuration [m].
        yaw: heading of the root there [rad].
        gap: gap between sole and surface [m].
        scene: scene that the robot stands on.
        robot: robot with a model of each limb.

    Raises:
        InputError: the robot's file does not describe its body or a limb's joints.
    """
    turn, (mass, com) = about("z", yaw), resting_mass(robot, posture.feet)
    moment = mass * (root + turn @ com)
    found, rotations, soles, corners = [], {}, {}, {}
    for foot in posture.feet:
        model, arms = limb_of(robot, foot), robot.effector(foot).corners
        pose, polygon = posture.feet[foot], np.asarray(scene.surfaces[posture.surfaces[foot]])
        normal = normal_of(polygon)
        rotation = foot_rotation(normal, pose.yaw)
        sole = pose.position + gap * normal
        found.append(
            (
                abs(float(normal @ (pose.position - polygon.mean(axis=0)))),
                f"{foot} on its surface's plane",
            )
        )
        found.append(
            (beyond_edges(polygon, normal, pose.position), f"{foot} within the surface's edges")
        )
        angles = _witness(model, turn.T @ (sole - root), turn.T @ rotation)
        frames, origins, reached, reached_turn = chain(model, angles)
        apart = [
            root + turn @ (reached + reached_turn @ arm) - (sole + rotation @ arm) for arm in arms
        ]
        found.append((float(np.linalg.norm(apart, axis=1).max()), f"reach of {foot}"))
        for frame, origin, weight, com in zip(
            frames, origins, model.link_mass, model.link_com, strict=True
        ):
            moment = moment + weight * (root + turn @ (origin + frame @ com))
            mass += float(weight)
        rotations[foot], soles[foot] = rotation, sole
        corners[foot] = _over_surface(polygon, normal, sole, rotation, arms)
    return Stood(found, rotations, soles, corners, moment / mass, mass)


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


def foot_rotation(normal: Float[np.ndarray, " 3"], yaw: float) -> Float[np.ndarray, "3 3"]:
    """Return the rotation with the normal as third column, whose first column heads along yaw."""
    ahead = np.array([math.cos(yaw), math.sin(yaw), 0.0])
    ahead[2] = -(normal[:2] @ ahead[:2]) / normal[2]
    ahead /= math.sqrt(float(ahead @ ahead))
    return np.column_stack([ahead, np.cross(normal, ahead), normal])


def normal_of(polygon: Float[np.ndarray, "V 3"]) -> Float[np.ndarray, " 3"]:
    """Return the unit normal, which points upwards."""
    arms = polygon[1:] - polygon[0]
    normal = np.cross(arms[:-1], arms[1:]).sum(axis=0)
    return normal * math.copysign(1.0, normal[2]) / math.sqrt(float(normal @ normal))


def beyond_edges(polygon: np.ndarray, normal: np.ndarray, point: np.ndarray) -> float:
    """Return how far a point is outside the polygon's worst edge [m]; negative inside."""
    outward = np.cross(np.roll(polygon, -1, axis=0) - polygon, normal)
    outward /= np.linalg.norm(outward, axis=1, keepdims=True)
    return float(((point - polygon) * outward).sum(axis=1).max())


def _witness(model: LimbModel, position: np.ndarray, rotation: np.ndarray) -> np.ndarray:
    """Return the angles of the inverse kinematics, clipped to the joint limits."""
    angles, _ = model.inverse(position, rotation)
    return np.clip(angles, model.chain.lower, model.chain.upper)


def _over_surface(
    polygon: np.ndarray,
    normal: np.ndarray,
    sole: np.ndarray,
    rotation: np.ndarray,
    arms: np.ndarray,
) -> np.ndarray:
    """Return the sole's corners, each moved towards the middle until it is over the surface."""
    corners = []
    for arm in arms:
        reach, share = rotation @ arm, 1.0
        for here, there in zip(polygon, np.roll(polygon, -1, axis=0), strict=True):
            outward = np.cross(there - here, normal)
            room, speed = float(outward @ (here - sole)), float(outward @ reach)
            if speed > 1e-12 * np.linalg.norm(outward):
                share = min(share, max(room, 0.0) / speed)
        corners.append(sole + share * reach)
    return np.array(corners)
