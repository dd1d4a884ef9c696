"""The certificate of postures: feet, legs, centre of mass and equilibrium, worked out again.

Shares no code with the sampling-based planner: joint by joint, posture by posture, with general
linear programs. Only the joint angles come from the closed-form inverse; they are a witness, held
within the joint limits here and then checked by the forward kinematics below.
"""

import math
from dataclasses import dataclass

import numpy as np
from scipy.optimize import linprog

from jaxleas.contacts.certificate import TOLERANCE, Violation
from jaxleas.contacts.plan import ContactPlan
from jaxleas.contacts.posture import Posture
from jaxleas.contacts.posture_model import Stood, limb_of, stand, two_point_margin
from jaxleas.robots import Robot, load_robot
from jaxleas.terrain.scene import Scene
from jaxleas.types import GuidePath, InputError

_SAME_FORCE = 1e-6
"""A recorded robustness may differ by this fraction from the one worked out again."""


@dataclass(frozen=True)
class PostureCertificate:
    """What was found.

    Attributes:
        worst: the constraint that is violated most; its `phase` is the posture's number.
        least_robustness: of all postures, worked out again [N].
        robustness_error: the largest relative difference to what the plan says.
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
        """What is wrong, as the end of a sentence; empty if nothing is."""
        worst = self.worst
        if not worst.certified:
            return f"violates {worst.constraint} in posture {worst.phase} by {worst.metres:.3g} m"
        if self.least_robustness < 0.0:
            return f"has a posture out of equilibrium, by {-self.least_robustness:.3g} N"
        if self.robustness_error > _SAME_FORCE:
            return f"states a robustness that is wrong by a fraction {self.robustness_error:.2g}"
        return ""


def certify_postures(
    plan: ContactPlan, guide: GuidePath, scene: Scene, robot: Robot | None = None
) -> PostureCertificate:
    """Recompute every constraint on the postures of a sampling plan.

    Each foot lies on its surface; one foot moves at a time; each leg reaches its foothold within
    its joint limits; the centre of mass is where the plan says; it can be over the standing foot
    while the other one moves, in reach of both (T app. B); the posture is in equilibrium with the
    robustness that the plan states. Collisions are not judged again.

    Args:
        plan: with postures.
        guide: that it follows.
        scene: that it crosses.
        robot: robot that the plan is for; Talos by default.

    Raises:
        InputError: the plan is none for this guide and scene.
    """
    postures = _require_fitting(plan, guide, scene)
    robot = robot or load_robot("talos")
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
        robustness = _robustness(stood, robot.friction)
        least = min(least, robustness)
        error = max(error, abs(robustness - said) / max(abs(robustness), 1.0))
        before = posture, stood
    return PostureCertificate(worst, least, error)


def _change(
    robot: Robot, before: Posture, stood_before: Stood, now: Posture, stood: Stood
) -> list[tuple[float, str]]:
    """Feet that did not move are where they were; one that did had somewhere to shift weight."""
    found = []
    for foot in now.feet:
        if foot != now.moved:
            one, two = before.feet[foot], now.feet[foot]
            moved = max(float(np.abs(one.position - two.position).max()), abs(one.yaw - two.yaw))
            found.append((moved, f"{foot} standing still"))
    if now.moved is not None:
        reaches = {foot: limb_of(robot, foot).com_reach for foot in now.feet}
        for which, text in ((stood_before, "leaves"), (stood, "lands")):
            margin = two_point_margin(which, now.moved, reaches)
            found.append((-margin, f"room for the centre of mass as {now.moved} {text}"))
    return found


def _robustness(stood: Stood, friction: float) -> float:
    """max b0 with G b = m [-g; c x -g], b_i >= b0, times |(sum_j g_j) x g_1| of one point.

    Torques about the world's origin; generators and points of their own.
    """
    columns, scale = [], 0.0
    for foot in stood.rotations:
        normal = stood.rotations[foot][:, 2]
        first = np.array([-normal[2], 0.0, normal[0]])  # n x e_y
        first = first / np.linalg.norm(first)
        second = np.cross(normal, first)
        cone = []
        for k in range(4):
            angle = math.pi / 4 + k * math.pi / 2
            g = normal + friction * (math.cos(angle) * first + math.sin(angle) * second)
            cone.append(g / np.linalg.norm(g))
        scale = float(np.linalg.norm(np.cross(np.sum(cone, axis=0), cone[0])))
        for point in stood.corners[foot]:
            columns += [np.concatenate([g, np.cross(point, g)]) for g in cone]
    G = np.column_stack(columns)
    # In units of the weight: the solver's tolerances are absolute, and ours is a millionth.
    newtons = stood.mass * 9.81
    weight = np.array([0.0, 0.0, 1.0])
    wrench = np.concatenate([weight, np.cross(stood.com, weight)])
    count = G.shape[1]
    answer = linprog(
        np.append(np.zeros(count), -1.0),
        A_ub=np.column_stack([-np.eye(count), np.ones(count)]),
        b_ub=np.zeros(count),
        A_eq=np.column_stack([G, np.zeros(6)]),
        b_eq=wrench,
        bounds=[(None, None)] * (count + 1),
        options={"primal_feasibility_tolerance": 1e-10, "dual_feasibility_tolerance": 1e-10},
    )
    return float(answer.x[-1]) * newtons * scale if answer.status == 0 else -math.inf


def _require_fitting(plan: ContactPlan, guide: GuidePath, scene: Scene) -> tuple[Posture, ...]:
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
        for foot, name in posture.surfaces.items():
            if name not in scene.surfaces:
                raise InputError(f"posture {number}: {foot} stands on '{name}', not in this scene")
    made = [posture for posture in plan.postures if posture.moved]
    footholds = np.array([each.feet[each.moved].position for each in made if each.moved])
    stated = np.zeros((0, 3)) if plan.footholds is None else plan.footholds
    if len(stated) != len(made) or (len(made) and np.abs(footholds - stated).max() > TOLERANCE):
        raise InputError("the plan's footholds are not those of the postures in which feet moved")
    return plan.postures
