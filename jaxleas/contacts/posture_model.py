"""One posture worked out the slow way: legs joint by joint, soles corner by corner."""

import math
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float
from scipy.optimize import linprog

from jaxleas.contacts.posture import Posture
from jaxleas.contacts.problem import FEET
from jaxleas.geometry.polytopes import Polytope
from jaxleas.robots import Robot
from jaxleas.robots.leg_kinematics import leg_angles
from jaxleas.robots.legs import LegModel
from jaxleas.terrain.scene import Scene

SIDES = {"LF": 1.0, "RF": -1.0}


@dataclass(frozen=True, eq=False)
class Stood:
    """A posture, worked out.

    Attributes:
        found: by how much each constraint on feet and legs is violated [m], and its name.
        rotations: of the feet in the world.
        soles: middle of each sole in the world [m].
        corners: of the part of each sole that is over its surface [m].
        com: of the whole robot in the world [m].
    """

    found: list[tuple[float, str]]
    rotations: dict[str, Float[np.ndarray, "3 3"]]
    soles: dict[str, Float[np.ndarray, " 3"]]
    corners: dict[str, Float[np.ndarray, "4 3"]]
    com: Float[np.ndarray, " 3"]


def stand(
    posture: Posture,
    root: Float[np.ndarray, " 3"],
    yaw: float,
    gap: float,
    scene: Scene,
    legs: LegModel,
    robot: Robot,
) -> Stood:
    """Work out a posture.

    Args:
        posture: of a sampling plan.
        root: of the guide's configuration [m].
        yaw: likewise [rad].
        gap: between sole and surface [m].
        scene: that it stands on.
        legs: their lengths, limits and masses.
        robot: size of its soles.
    """
    turn = about("z", yaw)
    moment = legs.body_mass * (root + turn @ legs.body_com)
    found, rotations, soles, corners = [], {}, {}, {}
    for foot in FEET:
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
        angles = _witness(legs, turn.T @ (sole - root), turn.T @ rotation, SIDES[foot])
        frames, origins, reached, reached_turn = chain(legs, angles, SIDES[foot])
        square = robot.foot_half_size
        apart = [
            root + turn @ (reached + reached_turn @ arm) - (sole + rotation @ arm)
            for arm in _arms(square)
        ]
        found.append((float(np.linalg.norm(apart, axis=1).max()), f"reach of {foot}"))
        side = np.diag([1.0, SIDES[foot], 1.0])
        for link in range(6):
            centre = origins[link] + frames[link] @ side @ legs.link_com[link]
            moment = moment + legs.link_mass[link] * (root + turn @ centre)
        rotations[foot], soles[foot] = rotation, sole
        corners[foot] = _over_surface(polygon, normal, sole, rotation, square)
    return Stood(found, rotations, soles, corners, moment / legs.mass)


def two_point_margin(stood: Stood, moving: str, com_in_foot: Polytope) -> float:
    """Return how much room the centre of mass has over the standing foot, in reach of both [m].

    Args:
        stood: the posture before the foot leaves, or after it has landed.
        moving: the other foot.
        com_in_foot: reach of the centre of mass from the left foot, turned by its yaw alone.
    """
    standing = "RF" if moving == "LF" else "LF"
    rows, bounds = [], []
    for foot in FEET:
        rotation, side = stood.rotations[foot], np.array([1.0, SIDES[foot], 1.0])
        turn = about("z", math.atan2(rotation[1, 0], rotation[0, 0]))
        normals = (com_in_foot.normals * side) @ turn.T
        rows.append(normals)
        bounds.append(com_in_foot.offsets + normals @ stood.soles[foot])
    corners = stood.corners[standing]
    for here, there in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        outward = np.array([there[1] - here[1], here[0] - there[0], 0.0])
        length = float(np.linalg.norm(outward))
        if length > 1e-9:
            rows.append(outward[None] / length)
            bounds.append(np.array([outward @ here / length]))
    A = np.concatenate(rows)
    answer = linprog(
        [0.0, 0.0, 0.0, -1.0],
        A_ub=np.column_stack([A, np.ones(len(A))]),
        b_ub=np.concatenate(bounds),
        bounds=[(None, None)] * 3 + [(None, 1.0)],
    )
    return float(answer.x[3]) if answer.status == 0 else -math.inf


def chain(
    legs: LegModel, angles: Float[np.ndarray, " 6"], side: float
) -> tuple[list[np.ndarray], list[np.ndarray], np.ndarray, np.ndarray]:
    """Place a leg's links in the root frame, one joint after the other.

    Args:
        legs: the left leg's model.
        angles: as this leg's own joints count them [rad].
        side: +1 left, -1 right.

    Returns:
        Frames of the six links, origins of their joints [m], the sole's position and rotation.
    """
    down = np.array([0.0, 0.0, -1.0])
    lengths = (0.0, 0.0, legs.thigh, legs.shank, 0.0, legs.sole)
    place, turn = legs.hip * np.array([1.0, side, 1.0]), np.eye(3)
    frames, origins = [], []
    for axis, angle, length in zip("zxyyyx", angles, lengths, strict=True):
        origins.append(place)
        turn = turn @ about(axis, float(angle))
        frames.append(turn)
        place = place + turn @ (length * down)
    return frames, origins, place, turn


def about(axis: str, angle: float) -> Float[np.ndarray, "3 3"]:
    """Return the rotation about a coordinate axis."""
    c, s = math.cos(angle), math.sin(angle)
    return {
        "x": np.array([[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]]),
        "y": np.array([[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]]),
        "z": np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]),
    }[axis]


def foot_rotation(normal: Float[np.ndarray, " 3"], yaw: float) -> Float[np.ndarray, "3 3"]:
    """Return the rotation whose third column is the normal and whose first one heads along yaw."""
    ahead = np.array([math.cos(yaw), math.sin(yaw), 0.0])
    ahead[2] = -(normal[:2] @ ahead[:2]) / normal[2]
    ahead /= math.sqrt(float(ahead @ ahead))
    return np.column_stack([ahead, np.cross(normal, ahead), normal])


def normal_of(polygon: Float[np.ndarray, "V 3"]) -> Float[np.ndarray, " 3"]:
    """Return the unit normal, upwards."""
    arms = polygon[1:] - polygon[0]
    normal = np.cross(arms[:-1], arms[1:]).sum(axis=0)
    return normal * math.copysign(1.0, normal[2]) / math.sqrt(float(normal @ normal))


def beyond_edges(polygon: np.ndarray, normal: np.ndarray, point: np.ndarray) -> float:
    """Return how far a point is outside the polygon's worst edge [m]; negative inside."""
    outward = np.cross(np.roll(polygon, -1, axis=0) - polygon, normal)
    outward /= np.linalg.norm(outward, axis=1, keepdims=True)
    return float(((point - polygon) * outward).sum(axis=1).max())


def _witness(legs: LegModel, sole: np.ndarray, rotation: np.ndarray, side: float) -> np.ndarray:
    """Return angles within the joint limits, as this leg's own joints count them."""
    mirror = np.diag([1.0, side, 1.0])
    angles, _ = leg_angles(legs, mirror @ sole, mirror @ rotation @ mirror)
    held = np.clip(angles, legs.lower, legs.upper)
    return held * np.array([side, side, 1.0, 1.0, 1.0, side])


def _arms(half_size: tuple[float, float]) -> list[np.ndarray]:
    """Return the sole's corners from its middle, counter-clockwise."""
    x, y = half_size
    return [np.array([a, b, 0.0]) for a, b in ((x, y), (-x, y), (-x, -y), (x, -y))]


def _over_surface(
    polygon: np.ndarray,
    normal: np.ndarray,
    sole: np.ndarray,
    rotation: np.ndarray,
    half_size: tuple[float, float],
) -> np.ndarray:
    """Return the sole's corners, each drawn in towards the middle until it is over the surface."""
    corners = []
    for arm in _arms(half_size):
        reach, share = rotation @ arm, 1.0
        for here, there in zip(polygon, np.roll(polygon, -1, axis=0), strict=True):
            outward = np.cross(there - here, normal)
            room, speed = float(outward @ (here - sole)), float(outward @ reach)
            if speed > 1e-12 * np.linalg.norm(outward):
                share = min(share, max(room, 0.0) / speed)
        corners.append(sole + share * reach)
    return np.array(corners)
