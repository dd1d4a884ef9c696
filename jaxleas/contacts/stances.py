"""The stances of a contact plan: poses of effectors on surfaces of any orientation."""

import math

import numpy as np
from jaxtyping import Float

from jaxleas.contacts.plan import ContactPlan
from jaxleas.contacts.problem import ContactProblem
from jaxleas.types import Contact, InputError, Pose, Stance

_ALONG = 1e-6


def contact_pose(
    position: Float[np.ndarray, " 3"], yaw: float, normal: Float[np.ndarray, " 3"]
) -> Pose:
    """Return the pose of an effector that lies flat on a surface.

    Its third axis is the surface's normal; its first one is the heading, turned into the surface,
    or straight up where the heading runs along the normal, as before a wall.

    Args:
        position: middle of the area that touches, in the world [m].
        yaw: heading about the vertical [rad].
        normal: unit normal of the surface, pointing away from it.
    """
    for ahead in (np.array([math.cos(yaw), math.sin(yaw), 0.0]), np.array([0.0, 0.0, 1.0])):
        first = ahead - (ahead @ normal) * normal
        length = float(np.linalg.norm(first))
        if length > _ALONG:
            first = first / length
            break
    second = np.cross(normal, first)
    return Pose.from_matrix(position, np.stack([first, second, normal], axis=1))


def stances_of(problem: ContactProblem, plan: ContactPlan) -> tuple[Stance, ...]:
    """Return the stance before the first step of a plan and after each step.

    Args:
        problem: contact problem.
        plan: plan of the problem; one that stops early gives the stances up to its end.

    Raises:
        InputError: an effector stands on no surface of the problem at the start.
    """
    stance = Stance.of(_initial(problem))
    stances = [stance]
    footholds = () if plan.footholds is None else plan.footholds
    for step, name, point in zip(problem.steps, plan.surfaces, footholds, strict=False):
        normal = problem.surfaces[name].normal
        stance = stance.making(Contact(step.foot, name, contact_pose(point, step.yaw, normal)))
        stances.append(stance)
    return tuple(stances)


def _initial(problem: ContactProblem) -> list[Contact]:
    contacts = []
    for name, foot in problem.initial.items():
        gaps = {each: float(s.distance(foot.position)) for each, s in problem.surfaces.items()}
        nearest = min(gaps, key=lambda each: gaps[each])
        if gaps[nearest] > 1e-3:
            raise InputError(f"{name} stands on no surface at the start: {gaps[nearest]:.3g} m off")
        pose = contact_pose(foot.position, foot.yaw, problem.surfaces[nearest].normal)
        contacts.append(Contact(name, nearest, pose))
    return contacts
