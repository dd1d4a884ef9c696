"""Candidates for a contact that pass every test but that of robustness, which costs most."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int

from jaxleas.contacts.sampling.candidates import Candidates
from jaxleas.contacts.sampling.case import PlanningCase
from jaxleas.contacts.sampling.move import Move
from jaxleas.contacts.sampling.placed_legs import legs_collide, mass_moments
from jaxleas.contacts.sampling.projection import project
from jaxleas.contacts.sampling.requirement import Requirement, Tally, count_left
from jaxleas.contacts.sampling.stance import support_corners
from jaxleas.contacts.sampling.standing_legs import StandingLegs, clear_of
from jaxleas.contacts.sampling.two_point import com_exists


@dataclass(frozen=True)
class Possible:
    """Candidates that passed all tests but robustness, best first within a row."""

    row: Int[np.ndarray, " M"]
    sole: Float[np.ndarray, "M 3"]
    rotation: Float[np.ndarray, "M 3 3"]
    surface: Int[np.ndarray, " M"]
    corners: Float[np.ndarray, "M C 3"]
    moment: Float[np.ndarray, "M 3"]

    def __getitem__(self, which) -> "Possible":
        return Possible(
            self.row[which],
            self.sole[which],
            self.rotation[which],
            self.surface[which],
            self.corners[which],
            self.moment[which],
        )


def possible_contacts(
    case: PlanningCase, move: Move, standing: StandingLegs, some: Candidates, tally: Tally | None
) -> Possible:
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
    return Possible(
        row=some.row[rows],
        sole=sole[rows],
        rotation=rotation[rows],
        surface=surface,
        corners=support_corners(
            case.ground, sole[rows], rotation[rows], surface, legs.corners[limb[rows]]
        ),
        moment=mass_moments(legs, placed[rows]),
    )
