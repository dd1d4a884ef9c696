"""Reading a chain's joints, axes and limits from a URDF, without a library for robots."""

import math
from dataclasses import dataclass
from pathlib import Path
from xml.etree import ElementTree

import numpy as np

from jaxleas.files import read_bytes
from jaxleas.robots.chain import SerialChain
from jaxleas.types import InputError, Pose

_HELD = ("fixed",)
_MOVED = ("revolute", "continuous")
_AHEAD = np.array([1.0, 0.0, 0.0])
_MOST_BYTES = 64 * 2**20


@dataclass(frozen=True)
class _Joint:
    name: str
    kind: str
    parent: str
    child: str
    position: np.ndarray
    rotation: np.ndarray
    axis: np.ndarray
    lower: float
    upper: float


def read_chain(path: str | Path, root: str, link: str, frame: Pose | None = None) -> SerialChain:
    """Return the chain of joints between two links of a URDF; fixed joints are folded into it.

    Args:
        path: URDF file.
        root: name of the link where the chain starts.
        link: name of the link that carries the effector.
        frame: pose of the effector in that link's frame; None for the frame itself.

    Raises:
        InputError: the file is not a URDF, has no such chain, or moves it by another kind of joint.
    """
    by_child = {joint.child: joint for joint in _joints(path)}
    joints, at = [], link
    while at != root:
        if at not in by_child or len(joints) > len(by_child):
            raise InputError(f"{path} has no chain of joints from link '{root}' to link '{link}'")
        joints.append(by_child[at])
        at = by_child[at].parent
    tip = Pose.identity() if frame is None else frame
    moved, position, rotation = [], np.zeros(3), np.eye(3)
    for joint in reversed(joints):
        position = position + rotation @ joint.position
        rotation = rotation @ joint.rotation
        if joint.kind in _HELD:
            continue
        if joint.kind not in _MOVED:
            raise InputError(
                f"{path}: joint '{joint.name}' is {joint.kind}; a limb's joints must be"
                f" {', '.join((*_MOVED, *_HELD))}"
            )
        moved.append((joint, position, rotation))
        position, rotation = np.zeros(3), np.eye(3)
    if not moved:
        raise InputError(f"{path}: no joint moves between link '{root}' and link '{link}'")
    return SerialChain(
        tuple(joint.name for joint, _, _ in moved),
        np.array([place for _, place, _ in moved]),
        np.array([turn for _, _, turn in moved]),
        np.array([joint.axis for joint, _, _ in moved]),
        np.array([joint.lower for joint, _, _ in moved]),
        np.array([joint.upper for joint, _, _ in moved]),
        Pose.from_matrix(position, rotation) @ tip,
    )


def _joints(path: str | Path) -> list[_Joint]:
    content = read_bytes(path, _MOST_BYTES)
    if b"<!DOCTYPE" in content or b"<!ENTITY" in content:
        raise InputError(f"{path} declares a document type, which no URDF needs; remove it")
    try:
        tree = ElementTree.fromstring(content)
    except ElementTree.ParseError as error:
        raise InputError(f"{path} is not a URDF: {error}") from error
    found = [_joint(path, each) for each in tree.findall("joint")]
    if tree.tag != "robot" or not found:
        raise InputError(f"{path} is not a URDF: it needs a <robot> with joints")
    return found


def _joint(path: str | Path, element: ElementTree.Element) -> _Joint:
    name, kind = element.get("name", ""), element.get("type", "")
    try:
        origin = element.find("origin")
        moves = kind in _MOVED
        direction = _three(element.find("axis"), "xyz", (1.0, 0.0, 0.0)) if moves else _AHEAD
        length = float(np.linalg.norm(direction))
        if length < 1e-9:
            raise ValueError("its axis is zero")
        limit = element.find("limit") if kind == "revolute" else None
        ends = (-math.pi, math.pi)
        if limit is not None:
            ends = float(limit.get("lower", 0.0)), float(limit.get("upper", 0.0))
        return _Joint(
            name,
            kind,
            _link(element, "parent"),
            _link(element, "child"),
            _three(origin, "xyz", (0.0, 0.0, 0.0)),
            rotation_of_rpy(*_three(origin, "rpy", (0.0, 0.0, 0.0)).tolist()),
            direction / length,
            *ends,
        )
    except ValueError as error:
        raise InputError(f"{path}: joint '{name}' is not one of a URDF: {error}") from error


def _link(element: ElementTree.Element, which: str) -> str:
    found = element.find(which)
    name = None if found is None else found.get("link")
    if name is None:
        raise ValueError(f"it names no {which} link")
    return name


def _three(element: ElementTree.Element | None, key: str, otherwise: tuple) -> np.ndarray:
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
