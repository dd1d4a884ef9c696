"""Why no foot makes a contact: the number of places that each of the planner's tests left."""

from collections.abc import Sequence

import numpy as np

from jaxleas.contacts.sampling.case import PlanningCase
from jaxleas.contacts.sampling.create import create_contacts
from jaxleas.contacts.sampling.guides import KeptGuides
from jaxleas.contacts.sampling.maintain import maintain_contacts
from jaxleas.contacts.sampling.move import Move
from jaxleas.contacts.sampling.requirement import Requirement, Tally
from jaxleas.contacts.sampling.stance import Stances

_NO_PLACE = "finds no contact: of {before} places none is "
_UNMET = {
    Requirement.OTHERS_CLEAR: "cannot move, as the legs of {others} touch each other",
    Requirement.LIFTED: "cannot be lifted: the centre of mass cannot be over {others}",
    Requirement.NEAR: "is near no surface with any of its leg's configurations",
    Requirement.WITHIN_LIMITS: _NO_PLACE + "within the joint limits",
    Requirement.CLEAR_OF_SCENE: _NO_PLACE + "clear of the scene",
    Requirement.CLEAR_OF_LEGS: _NO_PLACE + "clear of the other {leg}",
    Requirement.LOADED: _NO_PLACE + "within reach of the centre of mass over the other {foot}",
    Requirement.ROBUST: _NO_PLACE + "robust enough",
}
_MET = "finds a contact there, but not after repositioning"


def explain_feet(case: PlanningCase, guides: KeptGuides, stances: Stances, at: int) -> str:
    """Return, for each foot of the first guide path, why it makes no contact at a configuration.

    Args:
        case: robot, scene, settings.
        guides: guide path of the robot.
        stances: stance of its feet.
        at: index of the kept configuration that was not reached.
    """
    guide, here = np.zeros(1, dtype=np.int64), np.array([at])
    kept = maintain_contacts(case, guides.roots[guides.flat(guide, here)], stances[guide])
    sentences = []
    feet = case.robot.foot_names
    for limb, foot in enumerate(feet):
        others = [each for each in range(len(feet)) if each != limb]
        if stuck := [feet[other] for other in others if not kept.limb[0, other]]:
            names = " and ".join(stuck)
            stay = "it is" if len(stuck) == 1 else "they are"
            sentences.append(f"{foot} cannot move, as {names} cannot stay where {stay}")
            continue
        tally: Tally = {}
        aim = guides.aim(guide, here, np.array([limb]))
        create_contacts(case, Move(aim, stances[guide], order=guide), tally)
        sentences.append(f"{foot} {_first_unmet(tally, [feet[other] for other in others])}")
    return "; ".join(sentences)


def _first_unmet(tally: Tally, others: Sequence[str]) -> str:
    """Return what the test asked that left no place."""
    before, several = 0, len(others) > 1
    for requirement, left in tally.items():
        if left == 0:
            return _UNMET[requirement].format(
                before=before,
                others=" and ".join(others),
                leg="legs" if several else "leg",
                foot="feet" if several else "foot",
            )
        before = left
    return _MET
