"""The joints that a URDF states."""

import math
from dataclasses import dataclass
from pathlib import Path
from xml.etree import ElementTree

import numpy as np

from jaxleas.files import read_bytes
from jaxleas.types import InputError

HELD = ("fixed",)
MOVED = ("revolute", "continuous")
_SLIDES = ("prismatic",)
_AHEAD = np.array([1.0, 0.0, 0.0])
_MOST_BYTES = 64 * 2**20


@dataclass(frozen=True, eq=False)
class UrdfJoint:
    """A joint as a URDF states it.

    Attributes:
        name: name of the joint.
        kind: type of the joint, such as "revolute".
        parent: name of the link that carries it.
        child: name of the link that it moves.
        position: origin of the joint's frame in the frame of its parent [m].
        rotation: orientation of the joint's frame in the frame of its parent.
        axis: unit axis in the joint's own frame.
        lower: lower limit [rad, or m for a prismatic joint].
        upper: upper limit, likewise.
        mimics: whether it follows another joint.
    """

    name: str
    kind: str
    parent: str
    child: str
    position: np.ndarray
    rotation: np.ndarray
    axis: np.ndarray
    lower: float
    upper: float
    mimics: bool = False


def joint_motion(joint: UrdfJoint, value: float) -> tuple[np.ndarray, np.ndarray]:
    """Return how far a joint moves its child [m], and how it turns it, in the joint's frame.

    Args:
        joint: joint.
        value: angle [rad], or distance of a prismatic joint [m].
    """
    if joint.kind in _SLIDES:
        return value * joint.axis, np.eye(3)
    if joint.kind not in MOVED:
        return np.zeros(3), np.eye(3)
    x, y, z = joint.axis
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    turn = np.eye(3) + np.sin(value) * cross + (1.0 - np.cos(value)) * (cross @ cross)
    return np.zeros(3), turn


def urdf_element(path: str | Path) -> ElementTree.Element:
    """Return the <robot> of a URDF file.

    Raises:
        InputError: the file is missing, or is not a URDF.
    """
    content = read_bytes(path, _MOST_BYTES)
    if b"<!DOCTYPE" in content or b"<!ENTITY" in content:
        raise InputError(f"{path} declares a document type, which no URDF needs; remove it")
    try:
        tree = ElementTree.fromstring(content)
    except ElementTree.ParseError as error:
        raise InputError(f"{path} is not a URDF: {error}") from error
    if tree.tag != "robot" or not tree.findall("joint"):
        raise InputError(f"{path} is not a URDF: it needs a <robot> with joints")
    return tree


def urdf_joints(path: str | Path, element: ElementTree.Element) -> list[UrdfJoint]:
    """Return the joints of a <robot>.

    Args:
        path: URDF file, for messages.
        element: the <robot>.

    Raises:
        InputError: a joint is not one of a URDF.
    """
    return [_joint(path, each) for each in element.findall("joint")]


def _joint(path: str | Path, element: ElementTree.Element) -> UrdfJoint:
    name, kind = element.get("name", ""), element.get("type", "")
    try:
        origin = element.find("origin")
        moves = kind in (*MOVED, *_SLIDES)
        direction = three_numbers(element.find("axis"), "xyz", (1.0, 0.0, 0.0)) if moves else _AHEAD
        length = float(np.linalg.norm(direction))
        if length < 1e-9:
            raise ValueError("its axis is zero")
        limit = element.find("limit") if kind in ("revolute", *_SLIDES) else None
        ends = (-math.pi, math.pi)
        if limit is not None:
            ends = float(limit.get("lower", 0.0)), float(limit.get("upper", 0.0))
        return UrdfJoint(
            name,
            kind,
            _link(element, "parent"),
            _link(element, "child"),
            three_numbers(origin, "xyz", (0.0, 0.0, 0.0)),
            rotation_of_rpy(*three_numbers(origin, "rpy", (0.0, 0.0, 0.0)).tolist()),
            direction / length,
            *ends,
            element.find("mimic") is not None,
        )
    except ValueError as error:
        raise InputError(f"{path}: joint '{name}' is not one of a URDF: {error}") from error


def _link(element: ElementTree.Element, which: str) -> str:
    found = element.find(which)
    name = None if found is None else found.get("link")
    if name is None:
        raise ValueError(f"it names no {which} link")
    return name


def three_numbers(
    element: ElementTree.Element | None, key: str, otherwise: tuple[float, float, float]
) -> np.ndarray:
    """Return an attribute of three numbers.

    Args:
        element: element of a URDF; None for one that is not there.
        key: name of the attribute.
        otherwise: numbers where it is not there.

    Raises:
        ValueError: the attribute is not three finite numbers.
    """
    text = None if element is None else element.get(key)
    values = np.array(otherwise if text is None else [float(part) for part in text.split()])
    if values.shape != (3,) or not np.isfinite(values).all():
        raise ValueError(f"{key}='{text}' is not three finite numbers")
    return values


def rotation_of_rpy(roll: float, pitch: float, yaw: float) -> np.ndarray:
    """Return Rz(yaw) Ry(pitch) Rx(roll), as URDF defines these angles [rad]."""
    (cr, cp, cy), (sr, sp, sy) = np.cos([roll, pitch, yaw]), np.sin([roll, pitch, yaw])
    return np.array(
        [
            [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
            [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
            [-sp, cp * sr, cp * cr],
        ]
    )
