"""Keep the contacts while the root moves on: within reach, free of collisions, robust."""

from dataclasses import dataclass
from itertools import combinations

import numpy as np
from jaxtyping import Bool, Float

from jaxleas.contacts.sampling.case import PlanningCase
from jaxleas.contacts.sampling.leg_clearance import leg_capsules, legs_touch
from jaxleas.contacts.sampling.placed_legs import (
    body_moments,
    legs_collide,
    mass_moments,
    place_legs,
)
from jaxleas.contacts.sampling.roots import Roots
from jaxleas.contacts.sampling.stance import Stances


@dataclass(frozen=True)
class Maintained:
    """Contacts kept at new root poses, one row per robot.

    Attributes:
        limb: whether each leg alone can keep its contact.
        whole: whether the posture as a whole is valid: legs clear of each other, robust.
        com: centre of mass in the world [m].
    """

    limb: Bool[np.ndarray, "N F"]
    whole: Bool[np.ndarray, " N"]
    com: Float[np.ndarray, "N 3"]


def maintain_contacts(case: PlanningCase, roots: Roots, stances: Stances) -> Maintained:
    """Judge the same contacts at other root poses.

    The trunk's collisions depend on the guide path alone and are judged beforehand; the feet have
    not moved since they were judged.

    Args:
        case: robot, scene, settings.
        roots: root poses to judge.
        stances: contacts of the robots.
    """
    count, limbs = len(roots), stances.sole.shape[1]
    limb = np.tile(np.arange(limbs), count)
    pair = np.repeat(np.arange(count), limbs)
    placed = place_legs(
        case.legs,
        roots[pair],
        limb,
        stances.sole.reshape(-1, 3),
        stances.rotation.reshape(-1, 3, 3),
    )
    kept = placed.reachable.copy()
    rows = np.flatnonzero(kept)
    if len(rows):
        kept[rows] = ~legs_collide(case.legs, placed, rows, case.ground, feet=False)
    kept = kept.reshape(count, limbs)
    whole = np.all(kept, axis=1)
    capsules = leg_capsules(case.legs, placed)
    for one, other in combinations(range(limbs), 2):
        whole &= ~legs_touch(capsules[one::limbs], capsules[other::limbs])
    moments = mass_moments(case.legs, placed).reshape(count, limbs, 3).sum(axis=1)
    com = (body_moments(case.legs, roots) + moments) / case.legs.mass
    rows = np.flatnonzero(whole)
    if len(rows):
        whole[rows] = case.is_robust(stances[rows], com[rows])
    return Maintained(kept, whole, com)
