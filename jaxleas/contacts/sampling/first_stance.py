"""Two feet on the ground at the start of a guide path."""

from dataclasses import replace

import numpy as np
from jaxtyping import Bool, Float

from jaxleas.contacts.sampling.candidates import near_candidates
from jaxleas.contacts.sampling.case import PlanningCase
from jaxleas.contacts.sampling.create import Created, create_contacts, put
from jaxleas.contacts.sampling.database import align
from jaxleas.contacts.sampling.guides import KeptGuides
from jaxleas.contacts.sampling.limbs import (
    SIDES,
    Roots,
    legs_collide,
    place_legs,
    rotations_to_world,
    to_world,
)
from jaxleas.contacts.sampling.maintain import maintain_contacts
from jaxleas.contacts.sampling.stance import Stances, no_stances, support_corners

_FIRST_FEET = 8  # places tried for the left foot where the reference posture fails


def first_stances(case: PlanningCase, guides: KeptGuides) -> Created:
    """Return a robust stance at the first configuration of each guide path.

    The feet go below their places in the reference posture; where that fails, a few places for the
    left foot are tried, each with the best place for the right foot.

    Args:
        case: robot, scene, settings.
        guides: guide paths whose first configurations are used.
    """
    every = np.arange(len(guides.length))
    roots = guides.roots[guides.flat(every, 0 * every)]
    stances, standing = _reference_stances(case, roots, guides.reference_sole)
    kept = maintain_contacts(case, roots, stances)
    found = standing & kept.both
    result = Created(found, stances, kept.com.copy())
    for attempt in range(_FIRST_FEET):
        open_ = np.flatnonzero(~result.found)
        if not len(open_):
            break
        _stand_otherwise(case, guides, open_, attempt, result)
    return result


def _reference_stances(
    case: PlanningCase, roots: Roots, reference_sole: Float[np.ndarray, " 3"]
) -> tuple[Stances, Bool[np.ndarray, " N"]]:
    """Return feet on the highest surface below their reference places, and whether there is one."""
    ground, count = case.ground, len(roots)
    stances, good = no_stances(count), np.ones(count, dtype=bool)
    for limb in range(len(SIDES)):
        side = np.full(count, SIDES[limb])
        place = to_world(np.broadcast_to(reference_sole, (count, 3)), roots.yaw, side)
        place = place + roots.position
        heights = ground.heights_at(place[:, :2], roots.scene)
        below = np.where(heights <= roots.position[:, 2, None], heights, -np.inf)
        below = np.where(np.isnan(heights), -np.inf, below)
        surface = below.argmax(axis=1)
        height = below[np.arange(count), surface]
        good &= np.isfinite(height)
        normal = ground.normals[surface]
        sole = np.concatenate([place[:, :2], np.where(good, height, 0.0)[:, None]], axis=1)
        sole = sole + case.settings.contact_lift * normal
        level = np.broadcast_to(np.eye(3), (count, 3, 3))
        rotation = align(rotations_to_world(level, roots.yaw, side), normal)
        placed = place_legs(case.legs, roots, np.full(count, limb), sole, rotation)
        rows = np.flatnonzero(good)
        if len(rows):
            good[rows] = ~legs_collide(case.legs, placed, rows, ground, feet=True)
        stances.sole[:, limb], stances.rotation[:, limb] = sole, rotation
        stances.surface[:, limb], stances.since[:, limb] = surface, limb
        stances.corners[:, limb] = support_corners(
            ground, sole, rotation, surface, case.sole_half_size
        )
    return stances, good


def _stand_otherwise(
    case: PlanningCase, guides: KeptGuides, open_: np.ndarray, attempt: int, result: Created
) -> None:
    """Put the left foot on its next best place, the right one wherever that makes a stance."""
    start, left = 0 * open_, 0 * open_
    near = near_candidates(case, guides.aim(open_, start, left))
    # Neighbouring ranks are much alike: spread the attempts over them.
    row, first = np.unique(near.row[near.rank >= 3 * attempt], return_index=True)
    if not len(row):
        return
    chosen = near[np.flatnonzero(near.rank >= 3 * attempt)[first]]
    guide = open_[row]
    roots = guides.roots[guides.flat(guide, 0 * guide)]
    side, normal = np.full(len(row), SIDES[0]), case.ground.normals[chosen.surface]
    sole = to_world(case.database.soles[chosen.sample], roots.yaw, side) + roots.position
    above = (normal * sole).sum(axis=1) - case.ground.offsets[chosen.surface]
    sole = sole + (case.settings.contact_lift - above)[:, None] * normal
    turned = rotations_to_world(case.database.rotations[chosen.sample], roots.yaw, side)
    rotation = align(turned, normal)
    placed = place_legs(case.legs, roots, 0 * row, sole, rotation)
    good = np.flatnonzero(placed.reachable)
    good = good[~legs_collide(case.legs, placed, good, case.ground, feet=True)]
    if not len(good):
        return
    guide, sole, rotation, surface = (
        guide[good],
        sole[good],
        rotation[good],
        chosen.surface[good],
    )
    stances = no_stances(len(good))
    stances.sole[:, 0], stances.rotation[:, 0], stances.surface[:, 0] = sole, rotation, surface
    stances.corners[:, 0] = support_corners(
        case.ground, sole, rotation, surface, case.sole_half_size
    )
    # No swing leads into the first stance: the right foot "was" where the left one is.
    stances.sole[:, 1], stances.rotation[:, 1] = sole, rotation
    aim = guides.aim(guide, 0 * guide, 0 * guide + 1)
    made = create_contacts(case, aim, replace(stances), np.ones(len(good), dtype=np.int64))
    found = np.flatnonzero(made.found)
    result.found[guide[found]] = True
    result.com[guide[found]] = made.com[found]
    put(result.stances, guide[found], made.stances[found])
