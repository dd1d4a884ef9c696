"""A contact planner of the user's own: a class with settings and one method."""

import time
from dataclasses import dataclass
from typing import Any

import numpy as np

from jaxleas.contacts.planner import AskedGuides, Planner, mean_step
from jaxleas.contacts.settings import PlannerSettings
from jaxleas.terrain.scene import Scene
from jaxleas.types import GuidePath, Verdict
from jaxleas.types.errors import InputError


@dataclass(frozen=True)
class Outcome:
    """A planner's result for one guide path.

    Attributes:
        last_index: index of the last configuration of the guide path that it reached; -1: not even
            the first. It succeeded if this is the path's last.
        steps: number of contacts made along the path.
        reason: reason why it stopped, a sentence; required where it did not succeed.
        decided: False if it ran out of time: then the result is neither a success nor a failure.
    """

    last_index: int
    steps: int = 0
    reason: str = ""
    decided: bool = True


class OwnPlanner(PlannerSettings):
    """Base of a planner named as MODULE:CLASS; its fields are its settings.

    The settings are part of a verdict's provenance, as is the source file: verdicts of other
    settings or of changed code are never mixed. Workers in other processes import the module by its
    name.
    """

    def judge(self, scene: Scene, path: GuidePath) -> Outcome:
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
    outcome = planner.judge(scene, path)
    seconds = time.perf_counter() - begun
    name = f"{type(planner).__module__}:{type(planner).__name__}"
    if wrong := _contradiction(outcome, len(path)):
        raise InputError(f"{name} on guide path {number}: {wrong}")
    kept = np.arange(0, len(path), planner.keep_every)
    last = int(outcome.last_index)
    return Verdict(
        path=number,
        decided=bool(outcome.decided),
        success=bool(outcome.decided) and last == len(path) - 1,
        last_index=last,
        length=len(path),
        reached=float(np.mean(kept <= last)),
        steps=int(outcome.steps),
        mean_step=mean_step(path, last, int(outcome.steps)),
        repositions=None,
        least_robustness=None,
        mean_robustness=None,
        undecided=None,
        combinations=None,
        reason=outcome.reason,
        seconds=seconds,
    )


def _contradiction(outcome: Any, length: int) -> str:
    if not isinstance(outcome, Outcome):
        return f"judge returned {type(outcome).__name__}, not jaxleas.labels.Outcome"
    for field in ("last_index", "steps"):
        value = getattr(outcome, field)
        if isinstance(value, bool) or not isinstance(value, int | np.integer):
            return f"{field} is {value!r}, not a whole number"
    if not -1 <= outcome.last_index < length:
        return f"last_index is {outcome.last_index}, but it should be -1 to {length - 1}"
    if outcome.steps < 0:
        return f"steps is {outcome.steps}, but it should be 0 or more"
    whole = outcome.decided and outcome.last_index == length - 1
    if whole == bool(outcome.reason):
        return (
            f"the reason is {outcome.reason!r}, but a path that was followed to its end has none,"
            " and any other has one"
        )
    return ""
