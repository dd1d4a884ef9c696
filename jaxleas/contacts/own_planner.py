"""A contact planner of the user's own: a class with settings and one method."""

import time
from dataclasses import dataclass
from typing import Any

import numpy as np

from jaxleas.contacts.planner import AskedGuides, Planner, mean_step
from jaxleas.contacts.settings import PlannerSettings
from jaxleas.terrain import Scene
from jaxleas.types import (
    CAUSES,
    UNDECIDED_CAUSES,
    Cause,
    GuidePath,
    InputError,
    PathProgress,
    Verdict,
)


@dataclass(frozen=True)
class PlannerAnswer:
    """The answer of a planner of the user's own about one guide path.

    Attributes:
        last_index: index of the last configuration of the guide path that was reached; -1 if not
            even the first was. The planner succeeded if this is the path's last configuration.
        steps: number of contacts made along the path.
        reason: sentence that says why the planner stopped; required where it did not succeed.
        decided: whether the planner came to an answer; False where it ran out of time: then the
            path is neither a success nor a failure.
        cause: kind of reason, by which failures are counted; "other" where a planner that stopped
            states none, "time_limit" where it is undecided.
    """

    last_index: int
    steps: int = 0
    reason: str = ""
    decided: bool = True
    cause: Cause | None = None


Outcome = PlannerAnswer
"""The former name of `PlannerAnswer`."""


class OwnPlanner(PlannerSettings):
    """Base of a planner named as MODULE:CLASS; its fields are its settings.

    The settings are part of a verdict's provenance, as is the source file: verdicts of other
    settings or of changed code are never mixed. Workers in other processes import the module by its
    name.
    """

    def judge(self, scene: Scene, path: GuidePath) -> PlannerAnswer:
        """Plan contacts along a guide path.

        Args:
            scene: scene to walk on.
            path: guide path to follow; every `keep_every`-th configuration, from the first, counts.
        """
        raise NotImplementedError(f"{type(self).__name__} has no method judge(scene, path)")


class JudgedByOwn(Planner):
    """A planner of the user's own, in the form of the registry: it judges path by path."""

    def __init__(self, name: str, kind: type[OwnPlanner]) -> None:
        super().__init__(name)
        self.settings = kind

    @property
    def source(self) -> type:
        """The user's class."""
        return self.settings

    def judge(self, asked: AskedGuides, settings: OwnPlanner) -> list[Verdict]:
        """Judge guide paths one after the other."""
        return [judge_by_own(scene, path, settings, number) for number, scene, path in asked]


def judge_by_own(scene: Scene, path: GuidePath, planner: OwnPlanner, number: int = 0) -> Verdict:
    """Ask a planner of the user's own about one guide path, and check its answer.

    Raises:
        InputError: the answer contradicts itself or the path.
    """
    begun = time.perf_counter()
    answer = planner.judge(scene, path)
    seconds = time.perf_counter() - begun
    name = f"{type(planner).__module__}:{type(planner).__name__}"
    if wrong := _contradiction(answer, len(path)):
        raise InputError(f"{name} on guide path {number}: {wrong}")
    kept = np.arange(0, len(path), planner.keep_every)
    last, steps = int(answer.last_index), int(answer.steps)
    progress = PathProgress(
        path=number,
        length=len(path),
        last_index=last,
        reached=float(np.mean(kept <= last)),
        steps=steps,
        mean_step=mean_step(path, last, steps),
    )
    if not answer.reason:
        return Verdict.succeeded(progress, seconds)
    cause = answer.cause or ("other" if answer.decided else "time_limit")
    return Verdict.stopped(progress, cause, answer.reason, seconds)


def _contradiction(answer: Any, length: int) -> str:
    if not isinstance(answer, PlannerAnswer):
        return f"judge returned {type(answer).__name__}, not jaxleas.labels.PlannerAnswer"
    for field in ("last_index", "steps"):
        value = getattr(answer, field)
        if isinstance(value, bool) or not isinstance(value, int | np.integer):
            return f"{field} is {value!r}, not a whole number"
    if not -1 <= answer.last_index < length:
        return f"last_index is {answer.last_index}, but it should be -1 to {length - 1}"
    if answer.steps < 0:
        return f"steps is {answer.steps}, but it should be 0 or more"
    if answer.cause is not None and answer.cause not in CAUSES:
        return f"cause is {answer.cause!r}, but it should be one of {', '.join(CAUSES)}"
    whole = answer.decided and answer.last_index == length - 1
    if whole == bool(answer.reason):
        return (
            f"the reason is {answer.reason!r}, but a path that was followed to its end has none,"
            " and any other has one"
        )
    if answer.cause is not None and (whole or answer.decided == (answer.cause in UNDECIDED_CAUSES)):
        return (
            f"the cause is {answer.cause!r}, but a path that was followed to its end has none, and"
            f" {' and '.join(UNDECIDED_CAUSES)} are those of an undecided one"
        )
    return ""
