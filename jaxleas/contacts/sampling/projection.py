"""Candidates laid on their surfaces, with the legs that reach for them."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from jaxleas.contacts.sampling.candidates import Aim, Candidates
from jaxleas.contacts.sampling.case import PlanningCase
from jaxleas.contacts.sampling.database import align
from jaxleas.contacts.sampling.placed_legs import PlacedLegs, place_legs
from jaxleas.contacts.sampling.roots import rotations_to_world, to_world


@dataclass(frozen=True)
class Projected:
    """Feet on surfaces, one per candidate.

    Attributes:
        sole: middle of the sole in the world [m].
        rotation: rotation of the foot in the world, its third column along the surface's normal.
        placed: leg that reaches for it.
    """

    sole: Float[np.ndarray, "M 3"]
    rotation: Float[np.ndarray, "M 3 3"]
    placed: PlacedLegs


def project(case: PlanningCase, aim: Aim, some: Candidates) -> Projected:
    """Lay each candidate's sole on its surface, by the shortest way and the smallest turn.

    Args:
        case: robot, scene, settings.
        aim: aim of the moving legs.
        some: candidates for them.
    """
    databases, ground = case.databases, case.ground
    roots, limb = aim.roots[some.row], aim.limb[some.row]
    side, normal = case.legs.side[limb], ground.normals[some.surface]
    sole = to_world(databases.soles[some.sample], roots.yaw, side) + roots.position
    above = (normal * sole).sum(axis=1) - ground.offsets[some.surface]
    sole = sole + (case.settings.contact_lift - above)[:, None] * normal
    turned = rotations_to_world(databases.rotations[some.sample], roots.yaw, side)
    rotation = align(turned, normal)
    return Projected(sole, rotation, place_legs(case.legs, roots, limb, sole, rotation))
