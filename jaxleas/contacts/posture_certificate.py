"""The certificate of postures: feet, legs, centre of mass and equilibrium, computed anew.

Shares no code with the sampling-based planner: joint by joint, posture by posture, with general
linear programs and exact friction cones. Only the joint angles come from the limb's inverse; they
are a witness, held within the joint limits here and then checked by the forward kinematics below.
"""

import math
from dataclasses import dataclass

import numpy as np

from jaxleas.contacts.certificate import TOLERANCE, Violation
from jaxleas.contacts.plan import ContactPlan
from jaxleas.contacts.posture import Posture
from jaxleas.contacts.posture_balance import two_point_margin
from jaxleas.contacts.posture_model import Stood, stand
from jaxleas.dynamics import ContactPoints, exact_robustness
from jaxleas.robots import Robot
from jaxleas.terrain import Scene
from jaxleas.types import GuidePath, InputError

_SAME_FORCE = 1e-6
"""A recorded robustness may exceed the recomputed one by this fraction."""


@dataclass(frozen=True)
class PostureCertificate:
    """The result of a check.

    Attributes:
        worst: constraint that is violated most; its `step` is the posture's number.
        least_robustness: lower bound of all postures' robustness with exact friction cones [N].
        robustness_error: largest fraction by which the plan overstates a robustness.
    """

    worst: Violation
    least_robustness: float
    robustness_error: float

    @property
    def certified(self) -> bool:
        """Whether every posture holds."""
        return not self.complaint

    @property
    def complaint(self) -> str:
        """Description of what is wrong, as the end of a sentence; empty for a certified plan."""
        worst = self.worst
        if not worst.certified:
            much = f" by {worst.metres:.3g} m" if math.isfinite(worst.metres) else ": there is none"
            return f"violates {worst.constraint} in posture {worst.step}{much}"
        if self.least_robustness < 0.0:
            return f"has a posture out of equilibrium, by {-self.least_robustness:.3g} N"
        if self.robustness_error > _SAME_FORCE:
            return (
                f"states a robustness that is wrong: too large by {self.robustness_error:.2g} of it"
            )
        return ""


def certify_postures(
    plan: ContactPlan, guide: GuidePath, scene: Scene, robot: Robot
) -> PostureCertificate:
    """Recompute every constraint on the postures of a sampling plan.

    Each foot lies on its surface; one foot moves at a time; each leg reaches its foothold within
    its joint limits; the centre of mass is where the plan says; it can be above the standing feet
    while the other one moves, in reach of all (T app. B); the posture is in equilibrium and has
    the robustness that the plan states, with exact friction cones: planners that linearise the
    cones from inside state less than the exact value, never more. Collisions are not judged again.

    Args:
        plan: plan with postures.
        guide: guide path that the plan follows.
        scene: scene that the plan crosses.
        robot: robot that the plan is for.

    Raises:
        InputError: the plan does not belong to this guide, scene and robot.
    """
    postures = _require_fitting(plan, guide, scene, robot)
    worst, least, error = Violation(-math.inf, 0, ""), math.inf, 0.0
    before: tuple[Posture, Stood] | None = None
    assert plan.robustness is not None
    for number, (posture, said) in enumerate(zip(postures, plan.robustness, strict=True)):
        at = posture.configuration
        root = np.asarray(guide.position[at], np.float64)
        stood = stand(posture, root, float(guide.yaw[at]), plan.gap, scene, robot)
        found = [*stood.found, (np.linalg.norm(posture.com - stood.com), "centre of mass")]
        if before is not None:
            found += _change(robot, *before, posture, stood)
        metres, constraint = max(found)
        if metres > worst.metres:
            worst = Violation(float(metres), number, constraint)
        robustness = _robustness(stood, robot, enough=max(said, 0.0))
        least = min(least, robustness)
        error = max(error, (said - robustness) / max(abs(robustness), 1.0))
        before = posture, stood
    return PostureCertificate(worst, least, error)


def _change(
    robot: Robot, before: Posture, stood_before: Stood, now: Posture, stood: Stood
) -> list[tuple[float, str]]:
    """Return violations: an unmoved foot changed place, or a moved one could not shift weight."""
    found = []
    for foot in now.feet:
        if foot != now.moved:
            one, two = before.feet[foot], now.feet[foot]
            moved = max(float(np.abs(one.position - two.position).max()), abs(one.yaw - two.yaw))
            found.append((moved, f"{foot} standing still"))
    if now.moved is not None:
        for which, text in ((stood_before, "leaves"), (stood, "lands")):
            margin = two_point_margin(which, now.moved, robot)
            found.append((-margin, f"room for the centre of mass as {now.moved} {text}"))
    return found


def _robustness(stood: Stood, robot: Robot, enough: float) -> float:
    """Return the robustness with exact friction cones, or any lower bound from `enough` on."""
    points, normals, ahead, friction = [], [], [], []
    for foot, rotation in stood.rotations.items():
        count = len(stood.corners[foot])
        points.append(stood.corners[foot])
        normals.append(np.tile(rotation[:, 2], (count, 1)))
        ahead.append(np.tile(rotation[:, 0], (count, 1)))
        friction.append(np.full(count, robot.effector(foot).friction))
    contacts = ContactPoints(
        np.concatenate(points),
        np.concatenate(normals),
        np.concatenate(friction),
        np.concatenate(ahead),
    )
    return exact_robustness(contacts, stood.com, mass=stood.mass, enough=enough)


def _require_fitting(
    plan: ContactPlan, guide: GuidePath, scene: Scene, robot: Robot
) -> tuple[Posture, ...]:
    if not plan.postures or plan.robustness is None:
        raise InputError(f"this plan is '{plan.status}' and has no postures to check")
    if len(plan.robustness) != len(plan.postures):
        raise InputError(
            f"the plan has {len(plan.postures)} postures and {len(plan.robustness)} robustnesses"
        )
    order = [posture.configuration for posture in plan.postures]
    if order[0] != 0 or min(order) < 0 or max(order) >= len(guide) or sorted(order) != order:
        raise InputError(
            f"the plan goes from configuration {order[0]} to {order[-1]}, which does not follow"
            f" this guide with {len(guide)}"
        )
    if plan.feasible and order[-1] != len(guide) - 1:
        raise InputError(
            f"the plan calls itself feasible and ends at configuration {order[-1]} of"
            f" {len(guide) - 1}: perhaps it is for another guide"
        )
    for number, posture in enumerate(plan.postures):
        if sorted(posture.feet) != sorted(robot.foot_names):
            raise InputError(
                f"posture {number} has {', '.join(posture.feet)} in contact; robot '{robot.name}'"
                f" stands on {', '.join(robot.foot_names)}: perhaps the plan is another robot's"
            )
        for foot, name in posture.surfaces.items():
            if name not in scene.surfaces:
                raise InputError(f"posture {number}: {foot} stands on '{name}', not in this scene")
            if name not in scene.walkable:
                raise InputError(
                    f"posture {number}: {foot} stands on '{name}', which feet may not touch"
                )
    made = [posture for posture in plan.postures if posture.moved]
    footholds = np.array([each.feet[each.moved].position for each in made if each.moved])
    stated = np.zeros((0, 3)) if plan.footholds is None else plan.footholds
    if len(stated) != len(made) or (len(made) and np.abs(footholds - stated).max() > TOLERANCE):
        raise InputError("the plan's footholds are not those of the postures in which feet moved")
    return plan.postures
