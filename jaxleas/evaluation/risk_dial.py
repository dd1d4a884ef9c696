"""The risk dial, measured: what refusing guide paths costs and gains at every threshold.

The probability of success only falls along a guide path, so refusing below a threshold on the way
refuses the very guide paths whose last probability lies below it. One judgement of all guide
paths therefore shows what every threshold would have done.
"""

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from jaxtyping import Bool, Float

from jaxleas.envs.steering import SteeringEnv
from jaxleas.evaluation.exact_answers import Judged
from jaxleas.evaluation.judge import path_lengths
from jaxleas.evaluation.statistics import wilson_interval
from jaxleas.surrogates import Surrogate, foreseen_failure, label_paths
from jaxleas.terrain import Atlas


@dataclass(frozen=True)
class Guides:
    """N starts, their guide paths, what was foreseen and what was found.

    Attributes:
        reached: whether the guide path reached its goal.
        planned: whether the exact planner succeeded as well.
        survival: surrogate's probability that it succeeds; 0 where the goal was not reached.
        speed: mean speed of the root along the guide path [m/s].
    """

    reached: Bool[np.ndarray, " N"]
    planned: Bool[np.ndarray, " N"]
    survival: Float[np.ndarray, " N"]
    speed: Float[np.ndarray, " N"]


@dataclass(frozen=True)
class Setting:
    """What one threshold does.

    Attributes:
        threshold: threshold of the surrogate's probability.
        attempted: share of all starts whose guide path reaches its goal and is not refused.
        planned: share of all starts attempted and planned for by the exact planner.
        success: share of those attempted that were planned for; None where none was attempted.
        low: lower end of its 95 % interval (Wilson); None likewise.
        high: upper end of that interval; None likewise.
        speed: mean speed of the roots attempted [m/s]; None likewise.
        starts: number of starts in all.
    """

    threshold: float
    attempted: float
    planned: float
    success: float | None
    low: float | None
    high: float | None
    speed: float | None
    starts: int


def foresee(
    env: SteeringEnv, atlas: Atlas, judged: Judged, surrogate: Surrogate, time_step: float
) -> Guides:
    """Return what a surrogate foresaw, and an exact planner found, of a cell's guide paths.

    Args:
        env: environment whose local terrain the surrogate receives.
        atlas: terrains that were walked on.
        judged: roll-outs and verdicts of a cell.
        surrogate: surrogate that is asked.
        time_step: time between two configurations [s].
    """
    walked, keep = judged.roll_outs, surrogate.identity.keep_every
    rows = np.flatnonzero(walked.reached)
    survival = np.zeros(len(walked.reached))
    if len(rows):
        paths = [walked.guide_path(int(row), time_step) for row in rows]
        maps = np.asarray(walked.starts.map_index)[rows].tolist()
        last = [len(path) - 1 for path in paths]
        walks = label_paths(paths, last, maps, keep, 1 + max(last) // keep)
        survival[rows] = 1.0 - foreseen_failure(surrogate, env, atlas, walks)
    length, _ = path_lengths(walked)
    speed = length / np.maximum(walked.end * time_step, time_step)
    return Guides(walked.reached, judged.planned, survival, speed)


def join(parts: Sequence[Guides]) -> Guides:
    """Return the guide paths of several cells as one."""
    names = Guides.__dataclass_fields__
    return Guides(
        **{name: np.concatenate([getattr(each, name) for each in parts]) for name in names}
    )


def sweep(guides: Guides, thresholds: Sequence[float]) -> list[Setting]:
    """Return what each threshold does."""
    return [_setting(guides, threshold) for threshold in thresholds]


def _setting(guides: Guides, threshold: float) -> Setting:
    starts = len(guides.reached)
    attempted = guides.reached & (guides.survival >= threshold)
    good, tried = int((attempted & guides.planned).sum()), int(attempted.sum())
    low, high = wilson_interval(good, tried) if tried else (None, None)
    return Setting(
        threshold=threshold,
        attempted=tried / starts,
        planned=good / starts,
        success=good / tried if tried else None,
        low=low,
        high=high,
        speed=float(guides.speed[attempted].mean()) if tried else None,
        starts=starts,
    )


def as_json(settings: Sequence[Setting]) -> list[dict[str, Any]]:
    """Return settings as plain values, rounded as other results are."""
    return [
        {
            name: round(value, 6) if isinstance(value, float) else value
            for name, value in asdict(each).items()
        }
        for each in settings
    ]
