"""Ask an exact planner about guide paths over one scene or many, in this process."""

from collections.abc import Sequence

from jaxleas.contacts.sampling import SamplingPlan, SamplingSettings, plan_over
from jaxleas.labels.own_planner import OwnPlanner, judge_by_own
from jaxleas.labels.phase_planners import judge_by_phases
from jaxleas.labels.settings import PlannerSettings, require_settings
from jaxleas.labels.verdict import Verdict, mean_step
from jaxleas.terrain.scene import Scene
from jaxleas.types import GuidePath


def judge(
    planner: str,
    scene: Scene,
    guide_paths: Sequence[GuidePath],
    settings: PlannerSettings | None = None,
    first: int = 0,
) -> list[Verdict]:
    """Ask an exact planner about guide paths over one scene.

    Args:
        planner: its name: sampling, mip, sl1m, or MODULE:CLASS of one's own.
        scene: to walk on.
        guide_paths: to be judged.
        settings: of the planner; its defaults if None.
        first: number of the first guide path in its file.

    Raises:
        InputError: planner and settings do not fit, or a guide path cannot be used.
    """
    return judge_over(planner, [scene], guide_paths, [0] * len(guide_paths), settings, first)


def judge_over(
    planner: str,
    scenes: Sequence[Scene],
    guide_paths: Sequence[GuidePath],
    scene_index: Sequence[int],
    settings: PlannerSettings | None = None,
    first: int = 0,
) -> list[Verdict]:
    """Ask an exact planner about guide paths, each over one of several scenes.

    Args:
        planner: its name.
        scenes: to walk on.
        guide_paths: to be judged.
        scene_index: of each guide path's scene.
        settings: of the planner; its defaults if None.
        first: number of the first guide path.

    Returns:
        Verdicts in the order of the guide paths.
    """
    chosen = require_settings(planner, settings)
    if isinstance(chosen, OwnPlanner):
        return [
            judge_by_own(scenes[index], path, chosen, first + number)
            for number, (path, index) in enumerate(zip(guide_paths, scene_index, strict=True))
        ]
    if not isinstance(chosen, SamplingSettings):
        return [
            judge_by_phases(scenes[index], path, chosen, first + number)
            for number, (path, index) in enumerate(zip(guide_paths, scene_index, strict=True))
        ]
    plans = plan_over(scenes, guide_paths, scene_index, chosen)
    return [
        _verdict(first + number, path, plan)
        for number, (path, plan) in enumerate(zip(guide_paths, plans, strict=True))
    ]


def _verdict(number: int, path: GuidePath, plan: SamplingPlan) -> Verdict:
    stood = len(plan) > 0
    return Verdict(
        path=number,
        decided=True,
        success=plan.success,
        last_index=plan.last_index,
        length=len(path),
        reached=plan.reached,
        steps=plan.steps,
        mean_step=mean_step(path, plan.last_index, plan.steps),
        repositions=plan.repositions,
        least_robustness=float(plan.robustness.min()) if stood else None,
        mean_robustness=float(plan.robustness.mean()) if stood else None,
        undecided=None,
        combinations=None,
        reason=plan.reason,
        seconds=plan.seconds,
    )
