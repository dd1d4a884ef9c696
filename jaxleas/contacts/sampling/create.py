"""Make one contact with one foot while the other stands: candidates, projection, tests."""

from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Bool, Float, Int

from jaxleas.contacts.sampling.candidates import Aim, Candidates, near_candidates
from jaxleas.contacts.sampling.case import PlanningCase
from jaxleas.contacts.sampling.database import align
from jaxleas.contacts.sampling.leg_clearance import leg_segments, legs_touch
from jaxleas.contacts.sampling.limbs import (
    SIDES,
    PlacedLegs,
    body_moments,
    legs_collide,
    other_leg,
    place_legs,
    rotations_to_world,
    to_world,
)
from jaxleas.contacts.sampling.stance import Stances, support_corners
from jaxleas.contacts.sampling.two_point import com_exists
from jaxleas.robots.legs import mass_moment

_ROBUSTNESS_AT_FIRST = 3  # candidates tested first, of those that pass all other tests


@dataclass(frozen=True)
class Created:
    """New contacts, one row per robot.

    Attributes:
        found: whether there is a contact; the rest of the row has no meaning where not.
        stances: stances with the new contact in place of the old one.
        com: centre of mass of the new posture in the world [m].
    """

    found: Bool[np.ndarray, " N"]
    stances: Stances
    com: Float[np.ndarray, "N 3"]


@dataclass(frozen=True)
class _Tried:
    """Candidates that passed all tests but robustness, best first within a row."""

    row: Int[np.ndarray, " M"]
    sole: Float[np.ndarray, "M 3"]
    rotation: Float[np.ndarray, "M 3 3"]
    surface: Int[np.ndarray, " M"]
    corners: Float[np.ndarray, "M 4 3"]
    moment: Float[np.ndarray, "M 3"]

    def __getitem__(self, which) -> "_Tried":
        return _Tried(
            self.row[which],
            self.sole[which],
            self.rotation[which],
            self.surface[which],
            self.corners[which],
            self.moment[which],
        )


def create_contacts(
    case: PlanningCase,
    aim: Aim,
    stances: Stances,
    order: Int[np.ndarray, " N"],
    *,
    least_move: float = 0.0,
    tally: dict[str, int] | None = None,
) -> Created:
    """Give the moving foot of each robot the best new contact that passes every test.

    In order of cost: it projects onto the surface within the joint limits, the leg touches neither
    scene nor other leg, the two-point condition holds, and the posture's robustness is enough.

    Args:
        case: robot, scene, settings.
        aim: the moving limbs, and the poses of the roots when they land.
        stances: stances before the move; the other foot's contact is kept.
        order: value for `since` of the new contacts.
        least_move: distance by which the contact must move [m].
        tally: receives the number of places that each test leaves, in the order of the tests.
    """
    count = len(aim)
    each = np.arange(count)
    standing = other_leg(aim.limb)
    kept = place_legs(
        case.legs,
        aim.roots,
        standing,
        stances.sole[each, standing],
        stances.rotation[each, standing],
    )
    result = Created(np.zeros(count, dtype=bool), stances[each], np.zeros((count, 3)))
    can_leave = _two_points(case, aim, stances, each, stances.sole[each, aim.limb],
                            stances.rotation[each, aim.limb])  # fmt: skip
    candidates = near_candidates(case, aim)
    count_left(tally, "leave", int(can_leave.sum()))
    count_left(tally, "near", len(candidates.row))
    candidates = candidates[can_leave[candidates.row]]
    start = 0
    for stage in case.settings.stages:
        chosen = (candidates.rank >= start) & (candidates.rank < start + stage)
        chosen &= ~result.found[candidates.row]
        start += stage
        if chosen.any():
            tried = _try(case, aim, stances, kept, candidates[chosen], least_move, tally)
            _take_first_robust(case, aim, kept, tried, order, result)
            count_left(tally, "robust enough", int(result.found.sum()))
        if result.found.all():
            break
    return result


def count_left(tally: dict[str, int] | None, test: str, left: int) -> None:
    """Add to the number of places that a test left."""
    if tally is not None:
        tally[test] = tally.get(test, 0) + left


def _try(
    case: PlanningCase,
    aim: Aim,
    stances: Stances,
    kept: PlacedLegs,
    some: Candidates,
    least_move: float,
    tally: dict[str, int] | None,
) -> _Tried:
    """Return the candidates that pass all tests but robustness."""
    database, ground = case.database, case.ground
    roots, limb = aim.roots[some.row], aim.limb[some.row]
    side, normal = SIDES[limb], ground.normals[some.surface]
    sole = to_world(database.soles[some.sample], roots.yaw, side) + roots.position
    above = (normal * sole).sum(axis=1) - ground.offsets[some.surface]
    sole = sole + (case.settings.contact_lift - above)[:, None] * normal
    rotation = align(rotations_to_world(database.rotations[some.sample], roots.yaw, side), normal)
    placed = place_legs(case.legs, roots, limb, sole, rotation)
    before = stances.sole[some.row, limb]
    good = placed.reachable & (np.linalg.norm(sole - before, axis=1) >= least_move)
    rows = np.flatnonzero(good)
    count_left(tally, "within the joint limits", len(rows))
    rows = rows[~legs_collide(case.legs, placed, rows, ground, feet=True)]
    count_left(tally, "clear of the scene", len(rows))
    rows = _clear_of_other_leg(case, placed, kept, some.row, rows)
    count_left(tally, "clear of the other leg", len(rows))
    rows = rows[_two_points(case, aim, stances, some.row[rows], sole[rows], rotation[rows])]
    count_left(tally, "within reach of the centre of mass over the other foot", len(rows))
    passed = placed[rows]
    return _Tried(
        row=some.row[rows],
        sole=sole[rows],
        rotation=rotation[rows],
        surface=some.surface[rows],
        corners=support_corners(
            ground, sole[rows], rotation[rows], some.surface[rows], case.sole_half_size
        ),
        moment=mass_moment(case.legs, passed.frames, passed.origins),
    )


def _take_first_robust(
    case: PlanningCase,
    aim: Aim,
    kept: PlacedLegs,
    tried: _Tried,
    order: np.ndarray,
    result: Created,
) -> None:
    """Write the first robust candidate of each row into the result."""
    resting = body_moments(case.legs, aim.roots)
    resting = resting + mass_moment(case.legs, kept.frames, kept.origins)
    rank = np.arange(len(tried.row)) - np.searchsorted(tried.row, tried.row)
    for chosen in (rank < _ROBUSTNESS_AT_FIRST, rank >= _ROBUSTNESS_AT_FIRST):
        some = tried[chosen & ~result.found[tried.row]]
        if not len(some.row):
            continue
        limb = aim.limb[some.row]
        stances = with_contact(result.stances[some.row], limb, some, order[some.row])
        com = (resting[some.row] + some.moment) / case.legs.mass
        good = np.flatnonzero(case.is_robust(stances, com))
        row, first = np.unique(some.row[good], return_index=True)
        first = good[first]
        result.found[row] = True
        result.com[row] = com[first]
        put(result.stances, row, stances[first])


def with_contact(
    stances: Stances, limb: Int[np.ndarray, " N"], new: _Tried, order: Int[np.ndarray, " N"]
) -> Stances:
    """Return stances with one contact replaced in each row.

    The arrays of `stances` are changed in place: pass a fresh copy.
    """
    each = np.arange(len(limb))
    stances = replace(stances)
    stances.sole[each, limb], stances.rotation[each, limb] = new.sole, new.rotation
    stances.surface[each, limb], stances.corners[each, limb] = new.surface, new.corners
    stances.since[each, limb] = order
    return stances


def put(stances: Stances, rows: Int[np.ndarray, " M"], new: Stances) -> None:
    """Write stances into some rows of others."""
    stances.sole[rows], stances.rotation[rows] = new.sole, new.rotation
    stances.surface[rows], stances.corners[rows] = new.surface, new.corners
    stances.since[rows] = new.since


def _two_points(
    case: PlanningCase,
    aim: Aim,
    stances: Stances,
    row: np.ndarray,
    sole: np.ndarray,
    rotation: np.ndarray,
) -> Bool[np.ndarray, " M"]:
    """Return whether the centre of mass can be over the standing foot, with the other at `sole`."""
    standing = other_leg(aim.limb[row])
    return com_exists(
        case.legs.com_in_foot,
        stances.sole[row, standing],
        stances.rotation[row, standing],
        stances.corners[row, standing],
        sole,
        rotation,
        SIDES[standing],
    )


def _clear_of_other_leg(
    case: PlanningCase, placed: PlacedLegs, kept: PlacedLegs, row: np.ndarray, chosen: np.ndarray
) -> np.ndarray:
    moving = leg_segments(case.legs, placed[chosen])
    standing = leg_segments(case.legs, kept)[row[chosen]]
    return chosen[~legs_touch(case.legs, moving, standing)]
