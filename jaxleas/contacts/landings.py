"""The contacts that a plan makes, in order, as they are drawn: poses and sizes of what touches."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from jaxleas.contacts.plan import ContactPlan
from jaxleas.contacts.problem import ContactProblem
from jaxleas.contacts.stances import contact_pose
from jaxleas.robots import Robot, known_robot
from jaxleas.types import Pose

TOUCHING = 1e-3  # an effector this near to a surface stands on it [m]
UP = np.array([0.0, 0.0, 1.0])


@dataclass(frozen=True, eq=False)
class Landing:
    """An effector on a surface.

    Attributes:
        effector: name of the effector.
        pose: pose of the effector in the world; its third axis is the surface's normal.
        half_size: half length and half width of the touching area [m]; zeros for a point foot.
        step: number of steps that have been made when it lands; 0 for the initial stance.
    """

    effector: str
    pose: Pose
    half_size: tuple[float, float]
    step: int

    @property
    def corners(self) -> Float[np.ndarray, "C 3"]:
        """Corners of the touching area in the world, one for a point foot [m]."""
        x, y = self.half_size
        if x == y == 0.0:
            return np.asarray(self.pose.position)[None]
        square = np.array([[x, y, 0.0], [-x, y, 0.0], [-x, -y, 0.0], [x, -y, 0.0]])
        return self.pose.transform(square)


def landings_of(problem: ContactProblem, plan: ContactPlan) -> tuple[Landing, ...]:
    """Return the contacts of the initial stance, and one for each step of a plan.

    Args:
        problem: contact problem.
        plan: plan of the problem; one that stops early gives the contacts up to its end.
    """
    robot = known_robot(problem.robot)  # with polytopes of its own it may be of any
    landings = [
        Landing(
            name,
            contact_pose(foot.position, foot.yaw, _normal_at(problem, foot.position)),
            _half_size(robot, problem, name),
            0,
        )
        for name, foot in problem.initial.items()
    ]
    points = () if plan.footholds is None else plan.footholds
    for number, (step, point) in enumerate(zip(problem.steps, points, strict=False)):
        surface = problem.surfaces.get(plan.surfaces[number])
        normal = UP if surface is None else surface.normal
        pose = contact_pose(point, step.yaw, normal)
        landings.append(Landing(step.foot, pose, _half_size(robot, problem, step.foot), number + 1))
    return tuple(landings)


def _normal_at(problem: ContactProblem, point: Float[np.ndarray, " 3"]) -> np.ndarray:
    """Return the normal of the surface that a point lies on; upwards where it lies on none."""
    gaps = [(float(each.distance(point)), each) for each in problem.surfaces.values()]
    gap, nearest = min(gaps, key=lambda pair: pair[0], default=(np.inf, None))
    return UP if nearest is None or gap > TOUCHING else nearest.normal


def _half_size(robot: Robot | None, problem: ContactProblem, name: str) -> tuple[float, float]:
    """Return an effector's half sizes: the problem states those of soles, the robot the others."""
    known = {} if robot is None else {each.name: each for each in robot.effectors}
    effector = known.get(name)
    if effector is None or effector.kind == "foot":
        return problem.half_sizes[name]
    return effector.half_size
