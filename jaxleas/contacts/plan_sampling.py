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
from jaxleas.contacts.sampling.explanation import explain_feet
from jaxleas.contacts.sampling.planner import _Walk
from jaxleas.contacts.sampling.world import World, make_world
from jaxleas.contacts.surfaces import make_surface
from jaxleas.robots import Robot, load_robot
from jaxleas.terrain.scene import Scene
from jaxleas.types import GuidePath, InputError

MOST_BEYOND = 1.0
"""A root further than this from the scene's surfaces cannot stand on any of them [m]."""


def plan_sampling(
    guide: GuidePath,
    scene: Scene,
    settings: SamplingSettings | None = None,
    *,
    time_limit: float = math.inf,
    robot: Robot | None = None,
) -> ContactPlan:
    """Plan a robot's contacts along a guide path (T 4.1): acyclic, follows the guide exactly.

    A phase of the plan is a contact that was made; `postures` has both feet at every kept
    configuration. Without success the plan holds what was reached: "not_found" proves nothing.

    Args:
        guide: guide path to follow exactly.
        scene: surfaces to stand on and obstacles to avoid.
        settings: settings of the planner.
        time_limit: time limit, counted once the data base is made [s]; after it the plan's
            status is "time_limit".
        robot: robot with two legs; Talos by default.

    Raises:
        InputError: the guide or the scene cannot be used, or the guide leaves the scene.
        PlannerError: a bug of ours: the plan fails its certificate.
    """
    require_time_limit(time_limit)
    settings, robot = settings or SamplingSettings(), robot or load_robot("talos")
    world = make_world(robot, [scene], settings)
    feet = robot.foot_names
    begin = time.perf_counter()
    walk = _TimedWalk(world, guide, begin + time_limit)
    _require_over(scene, guide)
    walked = walk.plans()[0]
    seconds = time.perf_counter() - begin
    plan = contact_plan(walked, feet, settings.contact_lift).but(seconds=seconds)
    if walked.ending == "no_contact":
        plan = plan.but(reason=f"{plan.reason}: {walk.why()}")
    if walked.ending == "time_limit":
        late = f"not decided within the time limit of {time_limit:g} s"
        where = f"stopped at configuration {walked.last_index} of the guide path"
        plan = plan.but(status="time_limit", reason=f"{late}: {where}")
    if not len(walked):
        return plan
    certificate = certify_postures(plan, guide, scene, robot)
    if not certificate.certified:
        raise PlannerError(f"the sampling planner made a plan that {certificate.complaint}")
    return plan.but(max_violation=certificate.worst.metres)


def contact_plan(walked: SamplingPlan, feet: Sequence[str], gap: float) -> ContactPlan:
    """Return the sampling-based planner's answer as a contact plan, without a certificate.

    Args:
        walked: answer of the planner.
        feet: names of the robot's feet, in its order.
        gap: between a standing sole and its surface, `SamplingSettings.contact_lift` [m].
    """
    postures = tuple(_posture(walked, row, feet, gap) for row in range(len(walked)))
    made = [posture for posture in postures if posture.moved is not None]
    footholds = [each.feet[each.moved].position for each in made if each.moved]
    return ContactPlan(
        planner="sampling",
        feasible=walked.success,
        status="feasible" if walked.success else "not_found",
        reason=walked.reason,
        surfaces=tuple(each.surfaces[each.moved] for each in made if each.moved),
        footholds=np.array(footholds).reshape(-1, 3),
        last_feasible_phase=len(made) - 1,
        seconds=walked.seconds,
        robustness=tuple(walked.robustness.tolist()),
        postures=postures,
        gap=gap,
    )


def walked_problem(
    plan: ContactPlan, guide: GuidePath, scene: Scene, robot: Robot | None = None
) -> ContactProblem:
    """Return the steps of a sampling plan as a contact problem, each with the surface it used.

    The problem serves for pictures, and to ask another planner for the same steps. Model "feet".

    Args:
        plan: plan from `plan_sampling`.
        guide: guide path that the plan follows.
        scene: scene that the plan crosses.
        robot: robot that the plan is for; Talos by default.
    """
    robot, postures = robot or load_robot("talos"), plan.postures or ()
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


class _TimedWalk(_Walk):
    """One guide path, walked until a deadline."""

    def __init__(self, world: World, guide: GuidePath, deadline: float) -> None:
        super().__init__(world, [guide], [0])
        self.deadline = deadline

    def why(self) -> str:
        """Return why each foot makes no contact at the configuration after the last one."""
        return explain_feet(self.world, self.guides, self.stances, int(self.at[0]) + 1)

    def _go_on(self) -> tuple[np.ndarray, np.ndarray]:
        if time.perf_counter() > self.deadline:
            self._stop(np.flatnonzero(self.live), "time_limit", "its time is over")
        return super()._go_on()


def _posture(walked: SamplingPlan, row: int, feet: Sequence[str], gap: float) -> Posture:
    poses = {}
    for limb, foot in enumerate(feet):
        rotation = walked.rotations[row, limb]
        sole = walked.soles[row, limb] - gap * rotation[:, 2]
        poses[foot] = FootPose(sole, math.atan2(rotation[1, 0], rotation[0, 0]))
    moved = int(walked.moved[row])
    return Posture(
        configuration=int(walked.index[row]),
        how=walked.how[row],
        moved=None if moved < 0 else feet[moved],
        feet=poses,
        surfaces=dict(zip(feet, walked.surfaces[row], strict=True)),
        com=walked.com[row],
    )
