"""One posture computed the slow way: legs joint by joint, soles corner by corner."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from jaxleas.contacts.posture import Posture
from jaxleas.contacts.posture_limbs import about, chain, limb_of, resting_mass
from jaxleas.contacts.posture_soles import beyond_edges, foot_rotation, normal_of, over_surface
from jaxleas.robots import LimbModel, Robot
from jaxleas.terrain import Scene


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
        corners[foot] = over_surface(polygon, normal, sole, rotation, arms)
    return Stood(found, rotations, soles, corners, moment / mass, mass)


def _witness(model: LimbModel, position: np.ndarray, rotation: np.ndarray) -> np.ndarray:
    """Return the angles of the inverse kinematics, clipped to the joint limits."""
    angles, _ = model.inverse(position, rotation)
    return np.clip(angles, model.chain.lower, model.chain.upper)
