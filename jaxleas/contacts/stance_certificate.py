"""The certificate of a stance: every contact lies on its surface, is in reach, and all balance.

Shares no code with planners. Surfaces may have any orientation: floors, walls, ceilings.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float
from scipy.optimize import linprog
from scipy.sparse import csr_array

from jaxleas.contacts.certificate import TOLERANCE
from jaxleas.robots import Robot
from jaxleas.types import Contact, InputError, RootPose, Stance

GRAVITY = 9.81  # [m/s^2]
SIDES = 256
"""Generators of a friction cone, from inside: they miss 0.01 % of the friction."""
BALANCED = 1e-6
"""A stance whose forces miss the robot's weight by more than this share of it falls."""


@dataclass(frozen=True)
class StanceCertificate:
    """What was found.

    Attributes:
        metres: by how much the worst geometric constraint is violated [m].
        constraint: which one, in a few words.
        imbalance: force [N] and torque [N m] that no contact forces can balance, the larger one.
        weight: weight of the robot [N].
    """

    metres: float
    constraint: str
    imbalance: float
    weight: float

    @property
    def certified(self) -> bool:
        """Whether the stance holds."""
        return not self.complaint

    @property
    def complaint(self) -> str:
        """What is wrong, as the end of a sentence; empty if nothing is."""
        if not self.metres <= TOLERANCE:
            return f"violates {self.constraint} by {self.metres:.3g} m"
        if not self.imbalance <= BALANCED * self.weight:
            return f"is out of equilibrium by {self.imbalance:.3g} N"
        return ""


def certify_stance(
    robot: Robot,
    root: RootPose,
    stance: Stance,
    surfaces: Mapping[str, Float[np.ndarray, "V 3"]],
    com: Float[np.ndarray, " 3"],
) -> StanceCertificate:
    """Check a stance: contacts on surfaces, in reach of the root, in static equilibrium.

    Args:
        robot: robot that stands.
        root: pose of its root in the world.
        stance: contacts, at least one.
        surfaces: convex polygons by name, counter-clockwise seen from the side that is touched [m].
        com: centre of mass in the world [m].

    Raises:
        InputError: there is no contact, or one is of an effector or a surface that there is not.
    """
    if not len(stance):
        raise InputError("a stance without contacts cannot be certified: nothing carries the robot")
    found = []
    for name, contact in stance.contacts.items():
        if contact.surface not in surfaces:
            raise InputError(f"{name} is on '{contact.surface}', which is no surface given here")
        found += _on_surface(robot, contact, np.asarray(surfaces[contact.surface], np.float64))
        found.append(_reach(robot, root, contact))
    metres, constraint = max(found)
    return StanceCertificate(
        metres, constraint, _imbalance(robot, stance, com), robot.mass * GRAVITY
    )


def _on_surface(robot: Robot, contact: Contact, polygon: np.ndarray) -> list[tuple[float, str]]:
    """All of what touches lies in the plane and within the edges, and faces away from the surface.

    That the normals agree is measured at a metre's distance from the contact.
    """
    name = contact.effector
    corners = contact.pose.transform(robot.effector(name).corners)
    arms = polygon[1:] - polygon[0]
    normal = np.cross(arms[:-1], arms[1:]).sum(axis=0)  # a fan of triangles
    normal /= math.sqrt(float(normal @ normal))
    outward = np.cross(np.roll(polygon, -1, axis=0) - polygon, normal)
    outward /= np.linalg.norm(outward, axis=1, keepdims=True)
    beyond = np.einsum("cvk,vk->cv", corners[:, None] - polygon, outward)
    apart = np.abs((corners - polygon.mean(axis=0)) @ normal)
    return [
        (float(apart.max()), f"{name} on the plane of '{contact.surface}'"),
        (float(beyond.max()), f"{name} within the edges of '{contact.surface}'"),
        (
            float(np.linalg.norm(contact.normal - normal)),
            f"{name} facing away from '{contact.surface}'",
        ),
    ]


def _reach(robot: Robot, root: RootPose, contact: Contact) -> tuple[float, str]:
    limb = robot.limbs[robot.effector_index(contact.effector)]
    local = root.rotation.T @ (contact.pose.position - root.position)
    reach = limb.range_of_motion
    length = np.linalg.norm(reach.normals, axis=1)
    excess = (reach.normals @ local - reach.offsets) / length
    return float(excess.max()), f"reach of {contact.effector}"


def _imbalance(robot: Robot, stance: Stance, com: np.ndarray) -> float:
    """Return the least s with |sum f + m g| <= s and |sum (p - c) x f| <= s, f in the cones [N].

    The forces are sums of generators of the cones, from inside, so that what balances here does
    balance; a contact's normal force is at most its effector's limit.
    """
    wrenches, caps, limits = [], [], []
    for name, contact in stance.contacts.items():
        effector = robot.effector(name)
        points = contact.pose.transform(effector.corners)
        cone = _cone(contact.pose.rotation, effector.friction)
        for point in points:
            wrenches.append(np.concatenate([cone, np.cross(point - com, cone)], axis=1))
        caps.append((len(points) * SIDES, effector.force_limit))
    columns = np.concatenate(wrenches).T  # [6, all generators]
    count = columns.shape[1]
    weight = robot.mass * GRAVITY
    target = np.array([0.0, 0.0, 1.0, 0.0, 0.0, 0.0])  # in units of the weight
    slack = -np.ones((6, 1))
    rows = [np.hstack([columns, slack]), np.hstack([-columns, slack])]
    bounds = [target, -target]
    begin = 0
    for size, limit in caps:
        if limit is not None:
            row = np.zeros((1, count + 1))
            row[0, begin : begin + size] = 1.0  # a generator's normal part is 1
            rows.append(row)
            limits.append(limit / weight)
        begin += size
    answer = linprog(
        np.append(np.zeros(count), 1.0),
        A_ub=csr_array(np.concatenate(rows)),
        b_ub=np.concatenate([*bounds, limits]),
        bounds=(0.0, None),
    )
    return float(answer.x[-1]) * weight if answer.status == 0 else math.inf


def _cone(rotation: np.ndarray, friction: float) -> np.ndarray:
    """Return the generators n + mu (cos a t1 + sin a t2), which turn with the contact."""
    angles = 2.0 * np.pi * np.arange(SIDES) / SIDES
    circle = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    return rotation[:, 2] + friction * circle @ rotation[:, :2].T
