"""The certificate of a stance: every contact lies on its surface and in reach, in equilibrium.

Shares no code with the planners: friction cones are exact. Surfaces may have any orientation:
floors, walls, ceilings.
"""

import math
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float
from scipy.optimize import linprog
from scipy.sparse import csr_array

from jaxleas.contacts.certificate import TOLERANCE
from jaxleas.dynamics import GRAVITY, ContactPoints, exact_robustness
from jaxleas.robots import Robot
from jaxleas.terrain import Scene
from jaxleas.types import Contact, InputError, RootPose, Stance

_SIDES = 256
"""Generators of a friction cone, from inside, where forces are limited: 0.01 % less friction."""
_WITHIN = 1e-6
"""Limited forces that miss the robot's weight by more than this share do not carry it."""


@dataclass(frozen=True)
class StanceCertificate:
    """The result of a check.

    Attributes:
        metres: violation of the worst geometric constraint [m]; infinite where an effector is on a
            surface that it may not touch.
        constraint: the worst constraint, in a few words.
        robustness: robustness of equilibrium with exact friction cones [N]; negative: it falls.
        overload: share of the weight that limited forces cannot carry; 0 where no force is limited.
    """

    metres: float
    constraint: str
    robustness: float
    overload: float

    @property
    def certified(self) -> bool:
        """Whether the stance holds."""
        return not self.complaint

    @property
    def complaint(self) -> str:
        """Description of what is wrong, as the end of a sentence; empty for a certified stance."""
        if math.isinf(self.metres):
            return f"has {self.constraint}"
        if not self.metres <= TOLERANCE:
            return f"violates {self.constraint} by {self.metres:.3g} m"
        if not self.robustness >= 0.0:
            return f"is out of equilibrium: its robustness is {self.robustness:.3g} N"
        if not self.overload <= _WITHIN:
            return (
                "is carried by no forces within the effectors' limits, which leave"
                f" {100.0 * self.overload:.2g} % of the weight"
            )
        return ""


def certify_stance(
    robot: Robot,
    root: RootPose,
    stance: Stance,
    scene: Scene,
    com: Float[np.ndarray, " 3"],
) -> StanceCertificate:
    """Check a stance: contacts on surfaces, in reach of the root, in static equilibrium.

    Args:
        robot: robot that stands.
        root: pose of the robot's root in the world.
        stance: contacts to check, at least one.
        scene: surfaces of any orientation, and the effectors that may touch them.
        com: position of the centre of mass in the world [m].

    Raises:
        InputError: there is no contact, or one has an unknown effector or surface.
    """
    if not len(stance):
        raise InputError("a stance without contacts cannot be certified: nothing carries the robot")
    found = []
    for name, contact in stance.contacts.items():
        if contact.surface not in scene.surfaces:
            raise InputError(f"{name} is on '{contact.surface}', which is no surface of the scene")
        found.append(_permitted(robot, contact, scene))
        polygon = np.asarray(scene.surfaces[contact.surface], np.float64)
        found += _on_surface(robot, contact, polygon)
        found.append(_reach(robot, root, contact))
    metres, constraint = max(found)
    contacts = _contact_points(robot, stance)
    robustness = exact_robustness(contacts, com, mass=robot.mass)
    return StanceCertificate(metres, constraint, robustness, _overload(robot, stance, com))


def _permitted(robot: Robot, contact: Contact, scene: Scene) -> tuple[float, str]:
    """Return the violation, infinite where such an effector may not touch the surface."""
    stands = robot.effector(contact.effector).stands
    allowed, kind = (scene.walkable, "feet") if stands else (scene.pressable, "palms")
    wrong = contact.surface not in allowed
    text = f"{contact.effector} on '{contact.surface}', which {kind} may not touch"
    return (math.inf if wrong else -math.inf), text


def _on_surface(robot: Robot, contact: Contact, polygon: np.ndarray) -> list[tuple[float, str]]:
    """Return violations of: the contact is in the plane, within the edges, and faces away.

    The angle between the normals is measured at a distance of one metre from the contact.
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


def _contact_points(robot: Robot, stance: Stance) -> ContactPoints:
    points, normals, friction = [], [], []
    for name, contact in stance.contacts.items():
        effector = robot.effector(name)
        corners = contact.pose.transform(effector.corners)
        points.append(corners)
        normals.append(np.tile(contact.normal, (len(corners), 1)))
        friction.append(np.full(len(corners), effector.friction))
    return ContactPoints(np.concatenate(points), np.concatenate(normals), np.concatenate(friction))


def _overload(robot: Robot, stance: Stance, com: np.ndarray) -> float:
    """Return the least s with |sum f + g| <= s and |sum (p - c) x f| <= s, in units of the weight.

    The forces f are in the cones, and the normal force of an effector is at most its limit; torques
    have a lever arm of one metre. The result is 0 where no effector has a limit.
    """
    effectors = [robot.effector(name) for name in stance.contacts]
    if all(effector.force_limit is None for effector in effectors):
        return 0.0
    weight = robot.mass * GRAVITY
    wrenches, owners = [], []
    for number, (contact, effector) in enumerate(
        zip(stance.contacts.values(), effectors, strict=True)
    ):
        cone = _cone(contact.pose.rotation, effector.friction)
        for point in contact.pose.transform(effector.corners):
            wrenches.append(np.concatenate([cone, np.cross(point - com, cone)], axis=1))
            owners += [number] * len(cone)
    columns = np.concatenate(wrenches).T  # [6, all generators]
    target = np.array([0.0, 0.0, 1.0, 0.0, 0.0, 0.0])
    slack = -np.ones((6, 1))
    limits = np.array([effector.force_limit or np.inf for effector in effectors]) / weight
    limited = np.flatnonzero(np.isfinite(limits))
    normal_forces = (np.array(owners) == limited[:, None]).astype(float)  # each generator's is 1
    rows = [
        np.hstack([columns, slack]),
        np.hstack([-columns, slack]),
        np.hstack([normal_forces, np.zeros((len(limited), 1))]),
    ]
    answer = linprog(
        np.append(np.zeros(columns.shape[1]), 1.0),
        A_ub=csr_array(np.concatenate(rows)),
        b_ub=np.concatenate([target, -target, limits[limited]]),
        bounds=(0.0, None),
    )
    return float(answer.x[-1]) if answer.status == 0 else math.inf


def _cone(rotation: np.ndarray, friction: float) -> np.ndarray:
    """Return the generators n + mu (cos a t1 + sin a t2), which turn with the contact."""
    angles = 2.0 * np.pi * np.arange(_SIDES) / _SIDES
    circle = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    return rotation[:, 2] + friction * circle @ rotation[:, :2].T
