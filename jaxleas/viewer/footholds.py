"""The footholds of a contact plan: feet, palms and point feet on surfaces of any orientation."""

from dataclasses import dataclass

import numpy as np

from jaxleas.contacts import ContactPlan, ContactProblem, landings_of
from jaxleas.robots import Robot, known_robot
from jaxleas.types import Pose


@dataclass(frozen=True, eq=False)
class Foothold:
    """An effector on a surface.

    Attributes:
        effector: name of the effector.
        limb: index of its limb, in the robot's order.
        pose: pose of the effector in the world; its third axis is the surface's normal.
        half_size: half length and half width of the touching area [m]; zeros for a point foot.
        time: time at which the effector lands [s].
        until: time at which the same effector leaves [s]; infinity for its last foothold.
    """

    effector: str
    limb: int
    pose: Pose
    half_size: tuple[float, float]
    time: float
    until: float


def footholds_of(
    problem: ContactProblem, plan: ContactPlan, seconds_per_step: float
) -> tuple[Foothold, ...]:
    """Return the footholds of a plan in order of time; step k lands after k + 1 steps.

    Args:
        problem: contact problem.
        plan: plan of the problem; one that stops early gives the footholds up to its end.
        seconds_per_step: duration of a step [s]: a contact plan has no times.
    """
    robot = known_robot(problem.robot)  # with polytopes of its own it may be of any
    landings = landings_of(problem, plan)
    footholds = []
    for index, each in enumerate(landings):
        later = [other.step for other in landings[index + 1 :] if other.effector == each.effector]
        footholds.append(
            Foothold(
                effector=each.effector,
                limb=_limb_index(robot, problem, each.effector),
                pose=each.pose,
                half_size=each.half_size,
                time=each.step * seconds_per_step,
                until=min(later, default=np.inf) * seconds_per_step,
            )
        )
    return tuple(footholds)


def _limb_index(robot: Robot | None, problem: ContactProblem, name: str) -> int:
    known = () if robot is None else tuple(each.name for each in robot.effectors)
    names = known if name in known else problem.effectors
    return names.index(name) if name in names else len(names)
