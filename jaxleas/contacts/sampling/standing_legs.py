"""The legs that stand while one moves: what they leave to the moving one."""

from dataclasses import dataclass
from itertools import combinations

import numpy as np
from jaxtyping import Bool, Float, Int

from jaxleas.contacts.sampling.candidates import Aim
from jaxleas.contacts.sampling.case import PlanningCase
from jaxleas.contacts.sampling.leg_clearance import LegCapsules, leg_capsules, legs_touch
from jaxleas.contacts.sampling.placed_legs import (
    PlacedLegs,
    body_moments,
    mass_moments,
    place_legs,
)
from jaxleas.contacts.sampling.stance import Stances
from jaxleas.contacts.sampling.two_point import ComRegion, Soles, com_region


@dataclass(frozen=True)
class StandingLegs:
    """The legs of each robot that stand while one moves.

    Attributes:
        capsules: capsules of their legs, for each in turn.
        clear: whether no two of these legs touch.
        moment: mass times position of all but the moving leg, in the world [kg m].
        region: region in which the centre of mass can be.
    """

    capsules: tuple[LegCapsules, ...]
    clear: Bool[np.ndarray, " N"]
    moment: Float[np.ndarray, "N 3"]
    region: ComRegion


def place_standing(case: PlanningCase, aim: Aim, stances: Stances) -> StandingLegs:
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
    return StandingLegs(
        capsules=capsules,
        clear=clear,
        moment=body_moments(case.legs, aim.roots) + moments,
        region=com_region(case.legs, soles),
    )


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
