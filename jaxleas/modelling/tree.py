"""A URDF as a tree of links: who carries whom, and where each link is in a posture."""

import difflib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np

from jaxleas.modelling.bodies import LinkBody, read_bodies
from jaxleas.modelling.mesh_search import MeshSearch
from jaxleas.robots import UrdfJoint, joint_motion, urdf_element, urdf_joints
from jaxleas.types import InputError, Pose

MOVING = ("revolute", "continuous")
_MOST_LISTED = 60
_MOST_JOINTS = 500


@dataclass(frozen=True, eq=False)
class UrdfTree:
    """The links and joints of a URDF without loops.

    Attributes:
        path: URDF file.
        title: name that the URDF states.
        bodies: links, by name.
        joints: joints, in the order of the file.
        root: name of the link that nothing carries.
    """

    path: Path
    title: str
    bodies: Mapping[str, LinkBody]
    joints: tuple[UrdfJoint, ...]
    root: str

    @cached_property
    def above(self) -> dict[str, UrdfJoint]:
        """The joint that carries each link but the root, by the link's name."""
        return {joint.child: joint for joint in self.joints}

    def path_to(self, link: str, root: str | None = None) -> list[UrdfJoint]:
        """Return the joints from a root to a link.

        Raises:
            InputError: the root does not carry the link.
        """
        start, found = root or self.root, []
        at = link
        while at != start:
            if at not in self.above:
                raise InputError(
                    f"{self.path}: link '{start}' does not carry link '{link}'; the root of the"
                    f" file is '{self.root}'"
                )
            found.append(self.above[at])
            at = self.above[at].parent
        return found[::-1]

    def carrier(self, link: str) -> str:
        """Return the link below a joint that moves, or the root, that a link is fixed to."""
        while link in self.above and self.above[link].kind not in MOVING:
            link = self.above[link].parent
        return link

    def require_link(self, link: str, what: str) -> None:
        """Refuse the name of a link that the URDF does not have.

        Raises:
            InputError: lists the links that there are, the nearest first.
        """
        if link in self.bodies:
            return
        near = difflib.get_close_matches(link, self.bodies, n=3, cutoff=0.5)
        listed = [*near, *(each for each in self.bodies if each not in near)]
        more = f" and {len(listed) - _MOST_LISTED} more" if len(listed) > _MOST_LISTED else ""
        raise InputError(
            f"{self.path} has no link '{link}', which {what} names; it has"
            f" {', '.join(listed[:_MOST_LISTED])}{more}"
        )

    def neutral(self, stated: Mapping[str, float]) -> dict[str, float]:
        """Return a value for each joint: as stated, else as near to 0 as its limits allow."""
        angles = {each.name: float(np.clip(0.0, each.lower, each.upper)) for each in self.joints}
        return {**angles, **stated}

    def poses(self, angles: Mapping[str, float], root: str) -> dict[str, Pose]:
        """Return the pose of each link that a root carries, in the root's frame.

        Args:
            angles: values of joints, by name [rad, or m]; 0 for others.
            root: name of the root.
        """
        poses = {root: Pose.identity()}
        for joint in self._downward(root):
            offset, turn = joint_motion(joint, angles.get(joint.name, 0.0))
            frame = Pose.from_matrix(joint.position, joint.rotation)
            poses[joint.child] = poses[joint.parent] @ frame @ Pose.from_matrix(offset, turn)
        return poses

    def _downward(self, root: str) -> Iterator[UrdfJoint]:
        by_parent: dict[str, list[UrdfJoint]] = {}
        for joint in self.joints:
            by_parent.setdefault(joint.parent, []).append(joint)
        waiting = [root]
        while waiting:
            for joint in by_parent.get(waiting.pop(), ()):
                waiting.append(joint.child)
                yield joint


def read_tree(path: Path, search: MeshSearch) -> UrdfTree:
    """Return the links and joints of a URDF.

    Args:
        path: URDF file.
        search: where its meshes are; it is told which are missed.

    Raises:
        InputError: the file is no URDF, or its joints make a loop, or several robots.
    """
    if path.suffix.lower() == ".xacro":
        raise InputError(f"{path} is a xacro file: write the URDF that it makes, and give that")
    element = urdf_element(path)
    joints = tuple(urdf_joints(path, element))
    if len(joints) > _MOST_JOINTS:
        raise InputError(f"{path} has {len(joints)} joints, more than the {_MOST_JOINTS} accepted")
    bodies = read_bodies(path, element, search)
    children: set[str] = set()
    for joint in joints:
        for link in (joint.parent, joint.child):
            if link not in bodies:
                raise InputError(f"{path}: joint '{joint.name}' names a link '{link}', of none")
        if joint.child in children:
            first = next(each for each in joints if each.child == joint.child)
            raise InputError(
                f"{path} has a loop: joints '{first.name}' and '{joint.name}' both carry link"
                f" '{joint.child}'; a robot's file holds trees alone: cut the loop at one of them"
            )
        children.add(joint.child)
    carriers = {joint.parent for joint in joints}
    roots = [name for name in bodies if name not in children and name in carriers]
    if not roots:
        raise InputError(f"{path} has a loop: every link is carried by another one; cut it")
    if len(roots) > 1:
        raise InputError(
            f"{path} holds {len(roots)} trees, of the links {', '.join(roots[:5])}; a robot is one"
        )
    tree = UrdfTree(path, element.get("name") or path.stem, bodies, joints, roots[0])
    reached = len(tree.poses({}, roots[0]))
    if reached <= len(joints):
        raise InputError(f"{path} has a loop beside its tree: some links carry themselves; cut it")
    return tree
