"""Make one contact with one foot while all others stand: the best candidate that is robust."""

from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Bool, Float, Int

from jaxleas.contacts.sampling.candidates import near_candidates
from jaxleas.contacts.sampling.case import PlanningCase
from jaxleas.contacts.sampling.move import Move
from jaxleas.contacts.sampling.possible import Possible, possible_contacts
from jaxleas.contacts.sampling.requirement import Requirement, Tally, count_left
from jaxleas.contacts.sampling.stance import Stances, put
from jaxleas.contacts.sampling.standing_legs import StandingLegs, place_standing
from jaxleas.contacts.sampling.two_point import com_exists

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
    standing = place_standing(case, aim, stances)
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
            tried = possible_contacts(case, move, standing, candidates[chosen], tally)
            _take_first_robust(case, move, standing, tried, result)
            count_left(tally, Requirement.ROBUST, int(result.found.sum()))
        if result.found.all():
            break
    return result


def _take_first_robust(
    case: PlanningCase, move: Move, standing: StandingLegs, tried: Possible, result: Created
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
    stances: Stances, limb: Int[np.ndarray, " N"], new: Possible, order: Int[np.ndarray, " N"]
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
