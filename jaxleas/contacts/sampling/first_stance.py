"""All feet on the ground at the start of a guide path."""

import numpy as np
from jaxtyping import Bool, Float, Int

from jaxleas.contacts.sampling.candidates import Aim, Candidates, near_candidates
from jaxleas.contacts.sampling.case import PlanningCase
from jaxleas.contacts.sampling.create import Created, create_contacts
from jaxleas.contacts.sampling.database import align
from jaxleas.contacts.sampling.guides import KeptGuides
from jaxleas.contacts.sampling.leg_clearance import LegCapsules, leg_capsules
from jaxleas.contacts.sampling.maintain import maintain_contacts
from jaxleas.contacts.sampling.move import Move
from jaxleas.contacts.sampling.placed_legs import legs_collide, place_legs
from jaxleas.contacts.sampling.projection import project
from jaxleas.contacts.sampling.roots import Roots, rotations_to_world, to_world
from jaxleas.contacts.sampling.stance import Stances, no_stances, put, support_corners
from jaxleas.contacts.sampling.standing_legs import clear_of

_ATTEMPTS = 8  # places tried for the first foot where the reference posture fails
_APART = 3  # ranks from one such place to the next: neighbouring ranks are much alike


def first_stances(case: PlanningCase, guides: KeptGuides) -> Created:
    """Return a robust stance at the first configuration of each guide path.

    The feet go below their places in the reference posture; where that fails, a few places for the
    first foot are tried, each with the best places for the others, foot after foot.

    Args:
        case: robot, scene, settings.
        guides: guide paths whose first configurations are used.
    """
    every = np.arange(len(guides.length))
    roots = guides.roots[guides.flat(every, 0 * every)]
    stances, standing = _reference_stances(case, roots, guides.reference_sole)
    kept = maintain_contacts(case, roots, stances)
    found = standing & kept.whole
    result = Created(found, stances, kept.com.copy())
    for attempt in range(_ATTEMPTS):
        open_ = np.flatnonzero(~result.found)
        if not len(open_):
            break
        _stand_otherwise(case, guides, open_, attempt, result)
    return result


def _reference_stances(
    case: PlanningCase, roots: Roots, reference_sole: Float[np.ndarray, "F 3"]
) -> tuple[Stances, Bool[np.ndarray, " N"]]:
    """Return feet on the highest surface below their reference places, and whether there is one."""
    legs, ground, count = case.legs, case.ground, len(roots)
    stances, good = no_stances(legs, count), np.ones(count, dtype=bool)
    for foot in range(len(legs)):
        limb, side = np.full(count, foot), np.full(count, legs.side[foot])
        place = to_world(reference_sole[limb], roots.yaw, side)
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
        placed = place_legs(legs, roots, limb, sole, rotation)
        rows = np.flatnonzero(good)
        if len(rows):
            good[rows] = ~legs_collide(legs, placed, rows, ground, feet=True)
        stances.sole[:, foot], stances.rotation[:, foot] = sole, rotation
        stances.surface[:, foot], stances.since[:, foot] = surface, foot
        stances.corners[:, foot] = support_corners(
            ground, sole, rotation, surface, legs.corners[limb]
        )
    return stances, good


def _stand_otherwise(
    case: PlanningCase, guides: KeptGuides, open_: np.ndarray, attempt: int, result: Created
) -> None:
    """Put the first foot on its next best place, the others wherever that makes a stance."""
    guide, stances = open_, no_stances(case.legs, len(open_))
    capsules: tuple[LegCapsules, ...] = ()
    last = len(case.legs) - 1
    for foot in range(last):
        aim = guides.aim(guide, 0 * guide, np.full(len(guide), foot))
        near = near_candidates(case, aim)
        if foot == 0:
            near = near[np.flatnonzero(near.rank >= _APART * attempt)]
            near = near[np.unique(near.row, return_index=True)[1]]
        row, of_foot = _put_down(case, aim, near, capsules, stances)
        if not len(row):
            return
        guide, stances = guide[row], stances[row]
        capsules = (*(each[row] for each in capsules), of_foot)
    aim = guides.aim(guide, 0 * guide, np.full(len(guide), last))
    made = create_contacts(case, Move(aim, stances, np.full(len(guide), last), lifted=False))
    found = np.flatnonzero(made.found)
    result.found[guide[found]] = True
    result.com[guide[found]] = made.com[found]
    put(result.stances, guide[found], made.stances[found])


def _put_down(
    case: PlanningCase,
    aim: Aim,
    near: Candidates,
    capsules: tuple[LegCapsules, ...],
    stances: Stances,
) -> tuple[Int[np.ndarray, " M"], LegCapsules]:
    """Write the first possible contact of each row into the stances.

    Returns:
        Rows that have one, and the capsules of the legs that make it.
    """
    projected = project(case, aim, near)
    placed = projected.placed
    good = np.flatnonzero(placed.reachable)
    good = good[~legs_collide(case.legs, placed, good, case.ground, feet=True)]
    good = clear_of(case, placed, capsules, near.row, good)
    row, first = np.unique(near.row[good], return_index=True)
    good = good[first]
    limb, surface = aim.limb[row], near.surface[good]
    sole, rotation = projected.sole[good], projected.rotation[good]
    stances.sole[row, limb], stances.rotation[row, limb] = sole, rotation
    stances.surface[row, limb], stances.since[row, limb] = surface, limb
    stances.corners[row, limb] = support_corners(
        case.ground, sole, rotation, surface, case.legs.corners[limb]
    )
    return row, leg_capsules(case.legs, placed[good])
