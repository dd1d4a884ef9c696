"""Make one contact with one foot while all others stand: candidates, projection, tests."""

from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np
from jaxtyping import Bool, Float, Int

from jaxleas.contacts.sampling.candidates import Aim, Candidates, near_candidates
from jaxleas.contacts.sampling.case import PlanningCase
from jaxleas.contacts.sampling.leg_clearance import LegCapsules, leg_capsules, legs_touch
from jaxleas.contacts.sampling.placed_legs import (
    PlacedLegs,
    body_moments,
    legs_collide,
    mass_moments,
    place_legs,
)
from jaxleas.contacts.sampling.projection import project
from jaxleas.contacts.sampling.requirement import Requirement, Tally, count_left
from jaxleas.contacts.sampling.stance import Stances, support_corners
from jaxleas.contacts.sampling.two_point import ComRegion, Soles, com_exists, com_region

_ROBUSTNESS_AT_FIRST = 3  # candidates tested first, of those that pass all other tests


@dataclass(frozen=True)
class Move:
    """A move of one foot of each robot, one row per robot.

    Attributes:
        aim: moving legs, and the poses of the roots when their feet land.
        stances: stances before the move; the contacts of the other feet are kept.
        order: value for `since` of the new contacts.
        least: distance by which the contact must move [m].
        lifted: whether the foot leaves a contact; a foot that is put down at the start does not.
    """

    aim: Aim
    stances: Stances
    order: Int[np.ndarray, " N"]
    least: float = 0.0
    lifted: bool = True


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
class _Standing:
    """The feet of each robot that stand while one moves.

    Attributes:
        capsules: capsules of their legs, for each in turn.
        clear: whether these legs touch none of each other.
        moment: mass times position of all but the moving leg, in the world [kg m].
        region: where the centre of mass can be.
    """

    capsules: tuple[LegCapsules, ...]
    clear: Bool[np.ndarray, " N"]
    moment: Float[np.ndarray, "N 3"]
    region: ComRegion


@dataclass(frozen=True)
class _Tried:
    """Candidates that passed all tests but robustness, best first within a row."""

    row: Int[np.ndarray, " M"]
    sole: Float[np.ndarray, "M 3"]
    rotation: Float[np.ndarray, "M 3 3"]
    surface: Int[np.ndarray, " M"]
    corners: Float[np.ndarray, "M C 3"]
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


def create_contacts(case: PlanningCase, move: Move, tally: Tally | None = None) -> Created:
    """Give the moving foot of each robot the best new contact that passes every test.

    In order of cost: it projects onto the surface within the joint limits, the leg touches neither
    scene nor other legs, the two-point condition holds, and the posture's robustness is enough.

    Args:
        case: robot, scene, settings.
        move: move of one foot of each robot.
        tally: receives the number of places that each test leaves.
    """
    aim, stances, count = move.aim, move.stances, len(move.aim)
    each = np.arange(count)
    standing = _standing(case, aim, stances)
    result = Created(np.zeros(count, dtype=bool), stances[each], np.zeros((count, 3)))
    candidates = near_candidates(case, aim)
    candidates = candidates[standing.clear[candidates.row]]
    count_left(tally, Requirement.OTHERS_CLEAR, int(standing.clear.sum()))
    if move.lifted:
        before, turned = stances.sole[each, aim.limb], stances.rotation[each, aim.limb]
        can_leave = com_exists(case.legs, standing.region, aim.limb, before, turned)
        count_left(tally, Requirement.LIFTED, int(can_leave.sum()))
        count_left(tally, Requirement.NEAR, len(candidates.row))
        candidates = candidates[can_leave[candidates.row]]
    start = 0
    for stage in case.settings.stages:
        chosen = (candidates.rank >= start) & (candidates.rank < start + stage)
        chosen &= ~result.found[candidates.row]
        start += stage
        if chosen.any():
            tried = _try(case, move, standing, candidates[chosen], tally)
            _take_first_robust(case, move, standing, tried, result)
            count_left(tally, Requirement.ROBUST, int(result.found.sum()))
        if result.found.all():
            break
    return result


def _standing(case: PlanningCase, aim: Aim, stances: Stances) -> _Standing:
    """Place the legs that stand."""
    others = case.legs.others[aim.limb]
    count, feet = others.shape
    row = np.arange(count)[:, None]
    sole, rotation = stances.sole[row, others], stances.rotation[row, others]
    roots = aim.roots[np.repeat(np.arange(count), feet)]
    placed = place_legs(
        case.legs, roots, others.reshape(-1), sole.reshape(-1, 3), rotation.reshape(-1, 3, 3)
    )
    moments = mass_moments(case.legs, placed).reshape(count, feet, 3).sum(axis=1)
    together = leg_capsules(case.legs, placed)
    capsules = tuple(together[foot::feet] for foot in range(feet))
    clear = np.ones(count, dtype=bool)
    for one, other in combinations(capsules, 2):
        clear &= ~legs_touch(one, other)
    soles = Soles(others, sole, rotation, stances.corners[row, others])
    return _Standing(
        capsules=capsules,
        clear=clear,
        moment=body_moments(case.legs, aim.roots) + moments,
        region=com_region(case.legs, soles),
    )


def _try(
    case: PlanningCase, move: Move, standing: _Standing, some: Candidates, tally: Tally | None
) -> _Tried:
    """Return the candidates that pass all tests but robustness."""
    legs, limb = case.legs, move.aim.limb[some.row]
    projected = project(case, move.aim, some)
    sole, rotation, placed = projected.sole, projected.rotation, projected.placed
    moved = np.linalg.norm(sole - move.stances.sole[some.row, limb], axis=1)
    rows = np.flatnonzero(placed.reachable & (moved >= move.least))
    count_left(tally, Requirement.WITHIN_LIMITS, len(rows))
    rows = rows[~legs_collide(legs, placed, rows, case.ground, feet=True)]
    count_left(tally, Requirement.CLEAR_OF_SCENE, len(rows))
    rows = clear_of(case, placed, standing.capsules, some.row, rows)
    count_left(tally, Requirement.CLEAR_OF_LEGS, len(rows))
    region = standing.region[some.row[rows]]
    rows = rows[com_exists(legs, region, limb[rows], sole[rows], rotation[rows])]
    count_left(tally, Requirement.LOADED, len(rows))
    surface = some.surface[rows]
    return _Tried(
        row=some.row[rows],
        sole=sole[rows],
        rotation=rotation[rows],
        surface=surface,
        corners=support_corners(
            case.ground, sole[rows], rotation[rows], surface, legs.corners[limb[rows]]
        ),
        moment=mass_moments(legs, placed[rows]),
    )


def _take_first_robust(
    case: PlanningCase, move: Move, standing: _Standing, tried: _Tried, result: Created
) -> None:
    """Write the first robust candidate of each row into the result."""
    rank = np.arange(len(tried.row)) - np.searchsorted(tried.row, tried.row)
    for chosen in (rank < _ROBUSTNESS_AT_FIRST, rank >= _ROBUSTNESS_AT_FIRST):
        some = tried[chosen & ~result.found[tried.row]]
        if not len(some.row):
            continue
        limb = move.aim.limb[some.row]
        stances = _with_contact(result.stances[some.row], limb, some, move.order[some.row])
        com = (standing.moment[some.row] + some.moment) / case.legs.mass
        good = np.flatnonzero(case.is_robust(stances, com))
        row, first = np.unique(some.row[good], return_index=True)
        first = good[first]
        result.found[row] = True
        result.com[row] = com[first]
        put(result.stances, row, stances[first])


def _with_contact(
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


def clear_of(
    case: PlanningCase,
    placed: PlacedLegs,
    others: tuple[LegCapsules, ...],
    row: Int[np.ndarray, " M"],
    chosen: Int[np.ndarray, " K"],
) -> Int[np.ndarray, " L"]:
    """Return those of some moving legs that touch no other leg of their robot.

    Args:
        case: robot, scene, settings.
        placed: moving legs.
        others: capsules of other legs, one row per robot, for each of them in turn.
        row: robot of each moving leg.
        chosen: indices of the moving legs to judge.
    """
    moving = leg_capsules(case.legs, placed[chosen])
    touch = np.zeros(len(chosen), dtype=bool)
    for capsules in others:
        touch |= legs_touch(moving, capsules[row[chosen]])
    return chosen[~touch]
