"""MIP and SL1M as judges: guide path and scene -> contact problem -> verdict (T 5.2.3)."""

import time
from dataclasses import replace

import numpy as np

from jaxleas.contacts import (
    ContactPlan,
    ContactProblem,
    PlannerError,
    last_feasible_phase,
    plan_mip,
    plan_sl1m,
    problem_from_guide,
)
from jaxleas.contacts.from_guide import (
    BESIDE_ROOT,
    MOST_ASIDE,
    NoGroundError,
    kept_configurations,
)
from jaxleas.labels.settings import MipSettings, Sl1mSettings
from jaxleas.labels.verdict import Verdict, mean_step
from jaxleas.robots import load_robot
from jaxleas.terrain.scene import Scene
from jaxleas.types import GuidePath

ROBOT = "talos"


def judge_by_phases(
    scene: Scene, path: GuidePath, settings: MipSettings | Sl1mSettings, number: int = 0
) -> Verdict:
    """Ask MIP or SL1M, whichever the settings are of, about one guide path.

    Where there is no plan for the whole path, the last configuration reached is that of the last
    step of the longest prefix with a plan, found by dichotomic search. Standing beside the first
    configuration already reaches it.

    Args:
        scene: to walk on.
        path: the guide path.
        settings: of the planner.
        number: of the guide path, for the verdict.

    Raises:
        InputError: the guide path cannot be used.
    """
    begun = time.perf_counter()
    problem, lost = _problem(_around(scene, path, settings.window), path, settings)
    if problem is None or len(path) == 1:
        steps = -1 if lost is not None and lost.phase < 0 else 0
        reason = "" if lost is None else str(lost)
        verdict = _verdict(number, path, settings, steps, begun, None, reason)
        return replace(verdict, success=not reason)
    search = _Search(problem, settings, begun + settings.time_limit)
    first = search.plan(len(problem))
    decided, reason = True, ""
    if first is None:
        decided, reason = False, search.trouble
    elif not first.feasible:
        last = last_feasible_phase(problem, search.outcome)
        if last is None:
            decided, reason = False, search.trouble
        else:
            reason = _reason(problem, last + 1, first)
    elif lost is not None:
        reason = str(lost)
    verdict = _verdict(number, path, settings, search.made, begun, first, reason)
    return replace(verdict, decided=decided, success=decided and not reason)


class _Search:
    """Plans for ever other prefixes of a problem, within one time limit.

    `made` counts the phases of the longest prefix that has a certified plan.
    """

    def __init__(
        self, problem: ContactProblem, settings: MipSettings | Sl1mSettings, deadline: float
    ) -> None:
        self.problem, self.settings, self.deadline = problem, settings, deadline
        self.made, self.trouble = 0, ""

    def plan(self, phases: int) -> ContactPlan | None:
        """Plan for the first phases; None, with `trouble`, if that is not decided."""
        settings, prefix = self.settings, self.problem.prefix(phases)
        left = max(self.deadline - time.perf_counter(), 1e-3)
        try:
            if isinstance(settings, Sl1mSettings):
                plan = plan_sl1m(
                    prefix,
                    max_combinations=settings.max_combinations,
                    weights=settings.weights,
                    time_limit=left,
                    diagnose=False,
                )
            else:
                plan = plan_mip(prefix, time_limit=left, diagnose=False)
        except PlannerError as error:
            self.trouble = f"the planner failed: {error}"
            return None
        if plan.status == "time_limit":
            self.trouble = f"not decided within the time limit of {settings.time_limit:g} s"
            return None
        if plan.feasible:
            self.made = max(self.made, phases)
        return plan

    def outcome(self, prefix: ContactProblem) -> str:
        """Answer the question of the dichotomic search."""
        plan = self.plan(len(prefix))
        return "failed" if plan is None else "optimal" if plan.feasible else "infeasible"


def _problem(
    scene: Scene, path: GuidePath, settings: MipSettings | Sl1mSettings
) -> tuple[ContactProblem | None, NoGroundError | None]:
    """Return the problem of as much of the path as has ground, and what ends it before its end."""
    options = {
        "robot": ROBOT,
        "model": settings.model,
        "every": settings.keep_every,
        "candidates": settings.candidates,
        "window": settings.window,
        "first_foot": settings.first_foot,
    }
    try:
        if len(path) == 1:  # no step to make, but a place to stand on is needed
            path = path[np.array([0, 0])]
        return problem_from_guide(path, scene, **options), None
    except NoGroundError as error:
        if error.phase < 1:
            return None, error
        last = kept_configurations(len(path), settings.keep_every)[error.phase - 1]
        return problem_from_guide(path[: last + 1], scene, **options), error


def _around(scene: Scene, path: GuidePath, window: float) -> Scene:
    """Return the scene's surfaces that a foot can come near to on the way."""
    legs = [limb.range_of_motion.vertices[:, :2] for limb in load_robot(ROBOT).limbs]
    reach = max(float(np.linalg.norm(each, axis=1).max()) for each in legs)
    reach = max(reach, window) + BESIDE_ROOT + MOST_ASIDE
    places = np.asarray(path.position, dtype=np.float64)[:, :2]
    near = {}
    for name, vertices in scene.walkable.items():
        low, high = vertices[:, :2].min(axis=0) - reach, vertices[:, :2].max(axis=0) + reach
        if ((places >= low) & (places <= high)).all(axis=1).any():
            near[name] = vertices
    return Scene(near or scene.walkable, touch=dict.fromkeys(near or scene.walkable, "feet"))


def _reason(problem: ContactProblem, phase: int, plan: ContactPlan) -> str:
    step = problem.phases[phase]
    names = ", ".join(f"'{name}'" for name in step.candidates[:4])
    more = f" and {len(step.candidates) - 4} more" if len(step.candidates) > 4 else ""
    proof = "" if plan.status == "infeasible" else f" ({plan.reason})"
    return f"step {phase} ({step.foot} onto {names}{more}) is the first not made{proof}"


def _verdict(
    number: int,
    path: GuidePath,
    settings: MipSettings | Sl1mSettings,
    steps: int,
    begun: float,
    plan: ContactPlan | None,
    reason: str,
) -> Verdict:
    """Return a failure after so many steps, -1 for one without a start."""
    kept = [0, *kept_configurations(len(path), settings.keep_every)][: len(path)]
    last = kept[steps] if steps >= 0 else -1
    return Verdict(
        path=number,
        decided=True,
        success=False,
        last_index=last,
        length=len(path),
        reached=(steps + 1) / len(kept),
        steps=max(steps, 0),
        mean_step=mean_step(path, last, steps),
        repositions=None,
        least_robustness=None,
        mean_robustness=None,
        undecided=None if plan is None else plan.undecided,
        combinations=None if plan is None else plan.combinations,
        reason=reason,
        seconds=time.perf_counter() - begun,
    )
