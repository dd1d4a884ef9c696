"""Why neither foot makes a contact: the number of places that each of the planner's tests left."""

import numpy as np

from jaxleas.contacts.sampling.case import PlanningCase
from jaxleas.contacts.sampling.create import create_contacts
from jaxleas.contacts.sampling.guides import KeptGuides
from jaxleas.contacts.sampling.maintain import maintain_contacts
from jaxleas.contacts.sampling.stance import Stances


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
            sentences.append(f"{foot} cannot move, as {names} cannot stay where it is")
            continue
        tally: dict[str, int] = {}
        aim = guides.aim(guide, here, np.array([limb]))
        create_contacts(case, aim, stances[guide], guide, tally=tally)
        sentences.append(
            f"{foot} {_first_failed(tally, ' and '.join(feet[other] for other in others))}"
        )
    return "; ".join(sentences)


def _first_failed(tally: dict[str, int], other: str) -> str:
    """Return the test that left no place: the tally counts those left by each test, in order."""
    before = 0
    for test, left in tally.items():
        if left == 0:
            if test == "leave":
                return f"cannot be lifted: the centre of mass cannot be over {other}"
            if test == "near":
                return "is near no surface with any of its leg's configurations"
            return f"finds no contact: of {before} places none is {test}"
        before = left
    return "finds a contact there, but not after repositioning"
