"""Masses of a robot's legs and of all that is no leg."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from jaxleas.modelling.legs import Leg
from jaxleas.modelling.tree import UrdfTree
from jaxleas.robots import Body
from jaxleas.types import InputError, Pose

_DIGITS = 6


@dataclass(frozen=True, eq=False)
class Masses:
    """Masses of a robot.

    Attributes:
        body: all that is no leg, in the reference stance.
        links: mass of each link of each leg [kg].
        centres: centres of mass of these, in their frames [m].
    """

    body: Body
    links: tuple[Float[np.ndarray, " J"], ...]
    centres: tuple[Float[np.ndarray, "J 3"], ...]

    @property
    def total(self) -> float:
        """Mass of the robot [kg]."""
        return self.body.mass + sum(float(each.sum()) for each in self.links)


def masses_of(tree: UrdfTree, root: str, poses: Mapping[str, Pose], legs: Sequence[Leg]) -> Masses:
    """Return the masses of a robot; what hangs on a link of a leg counts with that link.

    Args:
        tree: links of the robot.
        root: name of the root.
        poses: poses of the links in the root frame, in the reference stance.
        legs: legs.

    Raises:
        InputError: the URDF states no mass.
    """
    owners = {
        joint.child: (number, leg.chain.names.index(joint.name))
        for number, leg in enumerate(legs)
        for joint in tree.path_to(leg.link, root)
        if joint.name in leg.chain.names
    }
    names = {place: link for link, place in owners.items()}
    masses = [np.zeros(len(leg.chain)) for leg in legs]
    moments = [np.zeros((len(leg.chain), 3)) for leg in legs]
    mass, moment = 0.0, np.zeros(3)
    for link, pose in poses.items():
        body, at = tree.bodies[link], link
        while at != root and at not in owners:
            at = tree.above[at].parent
        if at == root and at not in owners:
            mass += body.mass
            moment += body.mass * pose.transform(body.com[None])[0]
            continue
        number, index = owners[at]
        seen = poses[names[number, index]].inverse() @ pose
        masses[number][index] += body.mass
        moments[number][index] += body.mass * seen.transform(body.com[None])[0]
    if mass <= 0.0:
        raise InputError(
            f"{tree.path}: no link of the body of '{root}' has a mass; a robot's file needs it"
        )
    centres = [
        m / np.maximum(each, 1e-12)[:, None] for m, each in zip(moments, masses, strict=True)
    ]
    return Masses(
        Body(round(mass, _DIGITS), np.round(moment / mass, _DIGITS) + 0.0),
        tuple(np.round(each, _DIGITS) for each in masses),
        tuple(np.round(each, _DIGITS) + 0.0 for each in centres),
    )
