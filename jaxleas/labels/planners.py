"""The exact planners that can be asked for labels, by name."""

from collections.abc import Sequence

from jaxleas.contacts.sampling import SamplingPlan, SamplingSettings, plan_many
from jaxleas.labels.verdict import Verdict
from jaxleas.terrain.scene import Scene
from jaxleas.types import GuidePath, InputError

PLANNERS = ("sampling",)


def require_planner(name: str) -> None:
    """Refuse a planner that does not exist.

    Raises:
        InputError: says which do.
    """
    if name not in PLANNERS:
        raise InputError(
            f"there is no planner {name!r} for labels; there are {', '.join(PLANNERS)}"
        )


def judge(
    planner: str,
    scene: Scene,
    guide_paths: Sequence[GuidePath],
    settings: SamplingSettings,
    first: int = 0,
) -> list[Verdict]:
    """Ask an exact planner about guide paths over one scene.

    Args:
        planner: its name.
        scene: to walk on.
        guide_paths: to be judged.
        settings: of the planner.
        first: number of the first guide path in its file.
    """
    require_planner(planner)
    plans = plan_many(scene, guide_paths, settings)
    return [
        _verdict(first + number, len(path), plan)
        for number, (path, plan) in enumerate(zip(guide_paths, plans, strict=True))
    ]


def _verdict(number: int, length: int, plan: SamplingPlan) -> Verdict:
    stood = len(plan) > 0
    return Verdict(
        path=number,
        success=plan.success,
        last_index=plan.last_index,
        length=length,
        reached=plan.reached,
        steps=plan.steps,
        repositions=plan.repositions,
        least_robustness=float(plan.robustness.min()) if stood else None,
        mean_robustness=float(plan.robustness.mean()) if stood else None,
        reason=plan.reason,
        seconds=plan.seconds,
    )
