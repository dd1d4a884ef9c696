"""From a contact plan to its contact sequence."""

from collections.abc import Mapping

import numpy as np
from jaxtyping import Float

from jaxleas.contacts.plan import ContactPlan
from jaxleas.contacts.posture import Posture
from jaxleas.contacts.problem import ContactProblem
from jaxleas.contacts.sequence.values import ContactSequence, Landing
from jaxleas.contacts.stances import contact_pose, stances_of
from jaxleas.contacts.surfaces import ContactSurface
from jaxleas.robots import Effector, Robot, known_robot
from jaxleas.types import Contact, InputError, Stance


def sequence_of_steps(
    problem: ContactProblem, plan: ContactPlan, times: Float[np.ndarray, " L"], standing: float
) -> ContactSequence:
    """Return the sequence of a plan that answers a contact problem.

    Args:
        problem: contact problem that the plan answers.
        plan: plan of the problem.
        times: time of each landing [s].
        standing: share of the time between landings in which all effectors stand.
    """
    before, *after = stances_of(problem, plan)
    landings = [
        Landing(_on_whole(problem, stance[step.foot]), float(time))
        for stance, step, time in zip(after, problem.steps, times, strict=False)
    ]
    initial = Stance.of(_on_whole(problem, each) for each in before.contacts.values())
    sizes = {name: problem.half_sizes[name] for name in problem.initial}
    return ContactSequence(
        problem.robot, sizes, initial, tuple(landings), standing, _known(problem.robot)
    )


def sequence_of_postures(
    plan: ContactPlan,
    surfaces: Mapping[str, ContactSurface],
    robot: Robot,
    times: Float[np.ndarray, " L"],
    standing: float,
) -> ContactSequence:
    """Return the sequence of a plan that follows a guide path.

    Args:
        plan: plan with postures.
        surfaces: surfaces that it uses, by name.
        robot: robot that it is of.
        times: time of each landing [s].
        standing: share of the time between landings in which all effectors stand.

    Raises:
        InputError: the plan uses a surface that is missing, or an effector that the robot lacks.
    """
    postures = plan.postures or ()
    if not postures:
        raise InputError("the plan has no postures")
    first = postures[0]
    described = {each.name: each for each in robot.effectors}
    strange = [foot for foot in first.feet if foot not in described]
    if strange:
        raise InputError(
            f"the plan moves {', '.join(strange)}, which {robot.name} lacks: say --robot"
        )
    made = [each for each in postures if each.moved is not None]
    landings = [
        Landing(_contact(each, str(each.moved), surfaces), float(time))
        for each, time in zip(made, times, strict=True)
    ]
    initial = Stance.of(_contact(first, foot, surfaces) for foot in first.feet)
    sizes = {name: each.half_size for name, each in described.items() if name in first.feet}
    return ContactSequence(robot.name, sizes, initial, tuple(landings), standing, described)


def _contact(posture: Posture, foot: str, surfaces: Mapping[str, ContactSurface]) -> Contact:
    place, name = posture.feet[foot], posture.surfaces[foot]
    if name not in surfaces:
        raise InputError(f"the plan stands on surface '{name}', which is not in the scene")
    return Contact(foot, name, contact_pose(place.position, place.yaw, surfaces[name].normal))


def _on_whole(problem: ContactProblem, contact: Contact) -> Contact:
    """Return a contact with the surface of the scene, not the part of it that was a candidate."""
    return Contact(contact.effector, problem.whole(contact.surface), contact.pose)


def _known(robot: str) -> dict[str, Effector]:
    """Return the effectors of a robot by name; none of one that is not known here."""
    known = known_robot(robot)
    return {} if known is None else {each.name: each for each in known.effectors}
