"""The footholds of a contact plan: feet, palms and point feet on surfaces of any orientation."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from jaxleas.contacts import ContactPlan, ContactProblem, contact_pose
from jaxleas.robots import Robot, load_robot
from jaxleas.types import InputError, Pose

TOUCHING = 1e-3  # an effector this near to a surface stands on it [m]
UP = np.array([0.0, 0.0, 1.0])


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
    robot = _robot_of(problem)
    landings = [
        (name, contact_pose(foot.position, foot.yaw, _normal_at(problem, foot.position)), 0.0)
        for name, foot in problem.initial.items()
    ]
    points = () if plan.footholds is None else plan.footholds
    for index, (step, point) in enumerate(zip(problem.steps, points, strict=False)):
        surface = problem.surfaces.get(plan.surfaces[index])
        normal = UP if surface is None else surface.normal
        pose = contact_pose(point, step.yaw, normal)
        landings.append((step.foot, pose, (index + 1) * seconds_per_step))
    footholds = []
    for index, (name, pose, time) in enumerate(landings):
        leaves = [later for other, _, later in landings[index + 1 :] if other == name]
        footholds.append(
            Foothold(
                effector=name,
                limb=_limb_index(robot, problem, name),
                pose=pose,
                half_size=_half_size(robot, problem, name),
                time=time,
                until=min(leaves, default=np.inf),
            )
        )
    return tuple(footholds)


def _robot_of(problem: ContactProblem) -> Robot | None:
    try:
        return load_robot(problem.robot)
    except InputError:  # a contact problem with polytopes of its own may be of any robot
        return None


def _normal_at(problem: ContactProblem, point: Float[np.ndarray, " 3"]) -> np.ndarray:
    """Return the normal of the surface that a point lies on; upwards where it lies on none."""
    gaps = [(float(each.distance(point)), each) for each in problem.surfaces.values()]
    gap, nearest = min(gaps, key=lambda pair: pair[0], default=(np.inf, None))
    return UP if nearest is None or gap > TOUCHING else nearest.normal


def _limb_index(robot: Robot | None, problem: ContactProblem, name: str) -> int:
    known = () if robot is None else tuple(each.name for each in robot.effectors)
    names = known if name in known else problem.effectors
    return names.index(name) if name in names else len(names)


def _half_size(robot: Robot | None, problem: ContactProblem, name: str) -> tuple[float, float]:
    """Return an effector's half sizes: the problem states those of soles, the robot the others."""
    known = {} if robot is None else {each.name: each for each in robot.effectors}
    effector = known.get(name)
    if effector is None or effector.kind == "foot":
        return problem.half_sizes[name]
    return effector.half_size
