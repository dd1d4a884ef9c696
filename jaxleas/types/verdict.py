"""An exact planner's verdict on one guide path."""

from dataclasses import dataclass
from typing import Literal, Self

Cause = Literal[
    "no_start",
    "no_ground",
    "no_contact",
    "infeasible",
    "not_found",
    "collision",
    "repositions",
    "time_limit",
    "planner_failed",
    "other",
]
"""The kind of reason for which a planner stops before the end of a guide path."""
CAUSES: dict[Cause, str] = {
    "no_start": "no stance at the start of the guide path",
    "no_ground": "no surface near the root",
    "no_contact": "no contact that leads on",
    "infeasible": "a step proved impossible",
    "not_found": "a step not found by an incomplete planner",
    "collision": "a collision of the trunk",
    "repositions": "too many repositions of the feet",
    "time_limit": "the time limit",
    "planner_failed": "an error of the planner",
    "other": "another reason",
}
"""A description of each cause, for tables."""
UNDECIDED_CAUSES: tuple[Cause, ...] = ("time_limit", "planner_failed")
"""Causes that say nothing about the guide path: it is neither a success nor a failure."""


@dataclass(frozen=True)
class PathProgress:
    """The part of a guide path that a planner followed.

    Attributes:
        path: number of the guide path in its file, or in the call.
        length: number of configurations of the guide path.
        last_index: index of the last configuration reached; -1 if not even the first was.
        reached: share of the kept configurations that was reached [1].
        steps: number of contacts made after the start.
        mean_step: path length of the root per step, up to `last_index` [m]; None without a step.
    """

    path: int
    length: int
    last_index: int
    reached: float
    steps: int
    mean_step: float | None


@dataclass(frozen=True)
class PlannerMeasures:
    """Numbers that some planners report about a guide path; None where the planner has none.

    Attributes:
        repositions: number of steps that moved a foot while the root stood still.
        least_robustness: smallest robustness of all postures [N].
        mean_robustness: mean robustness of all postures [N].
        undecided: number of steps that SL1M's relaxation left without a surface.
        combinations: number of combinations of surfaces that SL1M tried.
    """

    repositions: int | None = None
    least_robustness: float | None = None
    mean_robustness: float | None = None
    undecided: int | None = None
    combinations: int | None = None


NO_MEASURES = PlannerMeasures()


@dataclass(frozen=True)
class Verdict:
    """The answer of an exact planner about one guide path.

    Made by `Verdict.succeeded` or `Verdict.stopped`.

    Attributes:
        path: number of the guide path in its file, or in the call.
        decided: whether the planner came to an answer: False where the time limit came first, or
            the planner failed; such a path is neither a success nor a failure.
        success: whether the planner reached the last configuration.
        last_index: index of the last configuration reached; -1 if not even the first was.
        length: number of configurations of the guide path.
        reached: share of the kept configurations that was reached [1].
        steps: number of contacts made after the start.
        mean_step: path length of the root per step, up to `last_index` [m]; None without a step.
        repositions: number of steps that moved a foot while the root stood still; None for planners
            without repositions.
        least_robustness: smallest robustness of all postures [N]; None without a posture, or for
            planners that do not compute it.
        mean_robustness: mean robustness of all postures [N]; None in the same cases.
        undecided: number of steps that SL1M's relaxation left without a surface; None for other
            planners.
        combinations: number of combinations of surfaces that SL1M tried; None for other planners.
        reason: sentence that says what stopped the planner; empty on success.
        seconds: time spent on planning [s].
        cause: kind of reason; None on success, and in files from before causes were recorded.
    """

    path: int
    decided: bool
    success: bool
    last_index: int
    length: int
    reached: float
    steps: int
    mean_step: float | None
    repositions: int | None = None
    least_robustness: float | None = None
    mean_robustness: float | None = None
    undecided: int | None = None
    combinations: int | None = None
    reason: str = ""
    seconds: float = 0.0
    cause: Cause | None = None

    @classmethod
    def succeeded(
        cls, progress: PathProgress, seconds: float, measures: PlannerMeasures = NO_MEASURES
    ) -> Self:
        """Return the verdict on a guide path that was followed to its end.

        Args:
            progress: the whole of the guide path.
            seconds: time spent on planning [s].
            measures: further numbers of the planner.
        """
        return cls(decided=True, success=True, seconds=seconds, **vars(progress), **vars(measures))

    @classmethod
    def stopped(
        cls,
        progress: PathProgress,
        cause: Cause,
        reason: str,
        seconds: float,
        measures: PlannerMeasures = NO_MEASURES,
    ) -> Self:
        """Return the verdict on a guide path that was not followed to its end.

        It is a failure, or undecided where the cause says nothing about the guide path.

        Args:
            progress: part of the guide path that was followed.
            cause: kind of reason.
            reason: sentence that says what stopped the planner.
            seconds: time spent on planning [s].
            measures: further numbers of the planner.
        """
        return cls(
            decided=cause not in UNDECIDED_CAUSES,
            success=False,
            reason=reason,
            seconds=seconds,
            cause=cause,
            **vars(progress),
            **vars(measures),
        )
