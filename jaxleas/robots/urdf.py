"""Reading a chain's joints, axes and limits from a URDF, without a library for robots."""

from collections.abc import Iterable, Mapping
from pathlib import Path

import numpy as np

from jaxleas.robots.chain import SerialChain
from jaxleas.robots.urdf_file import (
    HELD,
    MOVED,
    UrdfJoint,
    joint_motion,
    urdf_element,
    urdf_joints,
)
from jaxleas.types import InputError, Pose


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
    return chain_between(path, urdf_joints(path, urdf_element(path)), (root, link), frame)


def chain_between(
    path: str | Path,
    joints_of_file: Iterable[UrdfJoint],
    ends: tuple[str, str],
    frame: Pose | None = None,
    held: Mapping[str, float] | None = None,
) -> SerialChain:
    """Return what `read_chain` does, of joints that were read before.

    Args:
        path: URDF file, for messages.
        joints_of_file: all its joints.
        ends: names of the link where the chain starts, and of the one that carries the effector.
        frame: pose of the effector in that link's frame; None for the frame itself.
        held: angles of joints that do not move, by name [rad].

    Raises:
        InputError: as `read_chain`.
    """
    (root, link), held = ends, held or {}
    by_child = {joint.child: joint for joint in joints_of_file}
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
        if joint.kind in HELD:
            continue
        if joint.name in held:
            offset, turn = joint_motion(joint, held[joint.name])
            position, rotation = position + rotation @ offset, rotation @ turn
            continue
        if joint.kind not in MOVED:
            raise InputError(
                f"{path}: joint '{joint.name}' is {joint.kind}; a limb's joints must be"
                f" {', '.join((*MOVED, *HELD))}"
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
