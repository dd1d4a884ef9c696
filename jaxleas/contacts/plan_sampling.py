"""The sampling-based planner's answer as a contact plan, certified."""

import math
import time
from collections.abc import Sequence

import numpy as np

from jaxleas.contacts.plan import ContactPlan
from jaxleas.contacts.planner import PlannerError, require_time_limit
from jaxleas.contacts.polytopes import StepPolytopes
from jaxleas.contacts.posture import Posture
from jaxleas.contacts.posture_certificate import certify_postures
from jaxleas.contacts.problem import ContactProblem, FootPose, Step
from jaxleas.contacts.sampling import SamplingPlan, SamplingSettings
from jaxleas.contacts.sampling.case import make_case
from jaxleas.contacts.sampling.follower import GuideFollower
from jaxleas.contacts.surfaces import make_surface
from jaxleas.robots import Robot
from jaxleas.terrain import Scene
from jaxleas.types import Cause, GuidePath, InputError

CAUSE_OF_ENDING: dict[str, Cause] = {
    "trunk": "collision",
    "no_start": "no_start",
    "no_contact": "no_contact",
    "repositions": "repositions",
    "time_limit": "time_limit",
}
"""The cause of a failure, for each ending of a plan but "reached"."""
MOST_BEYOND = 1.0
"""A root further than this from the scene's surfaces cannot stand on any of them [m]."""


def plan_sampling(
    guide: GuidePath,
    scene: Scene,
    settings: SamplingSettings | None = None,
    *,
    time_limit: float = math.inf,
    robot: Robot,
) -> ContactPlan:
    """Plan a robot's contacts along a guide path (T 4.1): acyclic, follows the guide exactly.

    A phase of the plan is a contact that was made; `postures` has all feet at every kept
    configuration. Without success the plan holds what was reached: "not_found" proves nothing.

    Args:
        guide: guide path to follow exactly.
        scene: surfaces to stand on and obstacles to avoid.
        settings: settings of the planner.
        time_limit: time limit, counted once the data base is made [s]; after it the plan's
            status is "time_limit".
        robot: robot with two legs or more.

    Raises:
        InputError: the guide or the scene cannot be used, or the guide leaves the scene.
        PlannerError: a bug of ours: the plan fails its certificate.
    """
    require_time_limit(time_limit)
    settings = settings or SamplingSettings()
    case = make_case(robot, [scene], settings)
    feet = robot.foot_names
    begin = time.perf_counter()
    follower = GuideFollower(case, [guide], [0], begin + time_limit)
    _require_over(scene, guide)
    found = follower.plans()[0]
    seconds = time.perf_counter() - begin
    plan = contact_plan(found, feet, settings.contact_lift).but(seconds=seconds)
    if found.ending == "no_contact":
        plan = plan.but(reason=f"{plan.reason}: {follower.why_stopped()}")
    if found.ending == "time_limit":
        late = f"not decided within the time limit of {time_limit:g} s"
        where = f"stopped at configuration {found.last_index} of the guide path"
        plan = plan.but(status="time_limit", reason=f"{late}: {where}")
    if not len(found):
        return plan
    certificate = certify_postures(plan, guide, scene, robot)
    if not certificate.certified:
        raise PlannerError(f"the sampling planner made a plan that {certificate.complaint}")
    return plan.but(max_violation=certificate.worst.metres)


def contact_plan(found: SamplingPlan, feet: Sequence[str], gap: float) -> ContactPlan:
    """Return the sampling-based planner's answer as a contact plan, without a certificate.

    Args:
        found: answer of the planner.
        feet: names of the robot's feet, in its order.
        gap: distance between a standing sole and its surface, `SamplingSettings.contact_lift` [m].
    """
    postures = tuple(_posture(found, row, feet, gap) for row in range(len(found)))
    made = [posture for posture in postures if posture.moved is not None]
    footholds = [each.feet[each.moved].position for each in made if each.moved]
    return ContactPlan(
        planner="sampling",
        feasible=found.success,
        status="feasible" if found.success else "not_found",
        reason=found.reason,
        surfaces=tuple(each.surfaces[each.moved] for each in made if each.moved),
        footholds=np.array(footholds).reshape(-1, 3),
        last_feasible_step=len(made) - 1,
        seconds=found.seconds,
        robustness=tuple(found.robustness.tolist()),
        postures=postures,
        gap=gap,
        cause=CAUSE_OF_ENDING.get(found.ending),
    )


def problem_of_steps(
    plan: ContactPlan, guide: GuidePath, scene: Scene, robot: Robot
) -> ContactProblem:
    """Return the steps of a sampling plan as a contact problem, each with the surface it used.

    The problem serves for pictures, and to ask another planner for the same steps. Model "feet".

    Args:
        plan: plan from `plan_sampling`.
        guide: guide path that the plan follows.
        scene: scene that the plan crosses.
        robot: robot that the plan is for.
    """
    postures = plan.postures or ()
    return ContactProblem(
        robot=robot.name,
        model="feet",
        surfaces={
            name: make_surface(vertices, f"surface '{name}' of the scene")
            for name, vertices in scene.walkable.items()
        },
        initial=postures[0].feet if postures else {},
        steps=tuple(
            Step(
                each.moved,
                each.feet[each.moved].yaw,
                (each.surfaces[each.moved],),
                np.asarray(guide.position[each.configuration], np.float64),
            )
            for each in postures
            if each.moved
        ),
        polytopes=StepPolytopes({}, {}),
        half_sizes={each.name: each.half_size for each in robot.effectors},
    )


def _require_over(scene: Scene, guide: GuidePath) -> None:
    """Refuse a guide that leaves the rectangle around all surfaces by more than a leg's length."""
    corners = np.concatenate([np.asarray(each)[:, :2] for each in scene.walkable.values()])
    roots = np.asarray(guide.position, np.float64)
    beyond = np.maximum(corners.min(axis=0) - roots[:, :2], roots[:, :2] - corners.max(axis=0))
    outside = np.flatnonzero(beyond.max(axis=1) > MOST_BEYOND)
    if len(outside):
        x, y, z = roots[outside[0]]
        raise InputError(
            f"the guide leaves the scene: configuration {outside[0]}, with its root at"
            f" ({x:.2f}, {y:.2f}, {z:.2f}), is more than {MOST_BEYOND:g} m beyond every surface"
        )


def _posture(found: SamplingPlan, row: int, feet: Sequence[str], gap: float) -> Posture:
    poses = {}
    for limb, foot in enumerate(feet):
        rotation = found.rotations[row, limb]
        sole = found.soles[row, limb] - gap * rotation[:, 2]
        poses[foot] = FootPose(sole, math.atan2(rotation[1, 0], rotation[0, 0]))
    moved = int(found.moved[row])
    return Posture(
        configuration=int(found.index[row]),
        how=found.how[row],
        moved=None if moved < 0 else feet[moved],
        feet=poses,
        surfaces=dict(zip(feet, found.surfaces[row], strict=True)),
        com=found.com[row],
    )
