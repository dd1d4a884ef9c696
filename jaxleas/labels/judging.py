"""A judge: many guide paths over many scenes in one call, with persistent workers (T 4.2)."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from types import TracebackType
from typing import Self

import numpy as np

from jaxleas.contacts import PLANNERS, AskedGuides, PlannerSettings, find_planner, require_settings
from jaxleas.labels.planners import ask
from jaxleas.terrain import Scene
from jaxleas.types import GuidePath, InputError, Verdict
from jaxleas.workers import Workers, workers_for

PLANNER_MODULES = (
    "jaxleas.labels.planners",
    *(target.partition(":")[0] for target in PLANNERS.targets.values()),
)
"""Modules that workers of exact planners import before they are forked."""
_TASKS_EACH = 4  # tasks per worker, so that all workers end at about the same time


@dataclass(frozen=True)
class _Task:
    planner: str
    settings: PlannerSettings
    asked: AskedGuides


def planner_workers(count: int) -> Workers:
    """Return workers for exact planners: this process for one, several processes for more.

    Raises:
        InputError: the count is below 1.
    """
    return workers_for(count, PLANNER_MODULES)


class Judge:
    """An exact planner and the workers that run it; start-up is paid once.

        with Judge("mip", processes=2, robot="talos") as judge:
            verdicts = judge.judge(scenes, paths, scene_index)

    Attributes:
        planner: name of the planner, or MODULE:CLASS of your own.
        settings: settings of the planner.
        robot: name of the robot whose contacts it plans.
    """

    def __init__(
        self,
        planner: str,
        settings: PlannerSettings | None = None,
        processes: int = 1,
        workers: Workers | None = None,
        *,
        robot: str,
    ) -> None:
        """Choose planner and workers.

        Args:
            planner: name of a planner, or MODULE:CLASS of your own, which this call imports.
            settings: settings of the planner; its defaults if None.
            processes: number of processes that work; 1 works in this process.
            workers: workers to use instead of processes.
            robot: name of the robot.

        Raises:
            InputError: planner and settings do not fit, or the number of processes is below 1.
        """
        found = find_planner(planner, [planner])
        self.planner, self.robot, self._grain = planner, robot, found.grain
        self.settings = require_settings(found, settings, robot)
        self._workers = workers or planner_workers(processes)

    def judge(
        self,
        scenes: Sequence[Scene],
        paths: Sequence[GuidePath],
        scene_index: Sequence[int] | np.ndarray,
        on_done: Callable[[int], None] = lambda count: None,
    ) -> list[Verdict]:
        """Judge guide paths, each over one of the scenes.

        After Ctrl-C the judge can be asked again.

        Args:
            scenes: scenes that the paths cross.
            paths: guide paths to judge.
            scene_index: index of each path's scene.
            on_done: function called with the number of further guide paths that are done.

        Returns:
            Verdicts in the order of the paths, each with its number.

        Raises:
            InputError: a path or scene cannot be used, or the indices do not fit.
            WorkerError: workers die over the same paths repeatedly.
        """
        index = np.asarray(scene_index, dtype=np.int64)
        _require_fit(len(scenes), len(paths), index)
        groups = self._groups(index)
        tasks = [self._task(scenes, paths, index, group) for group in groups]
        verdicts: list[Verdict | None] = [None] * len(paths)
        for number, answers in self._workers.run(_judge_task, tasks):
            for path, verdict in zip(groups[number].tolist(), answers, strict=True):
                verdicts[path] = replace(verdict, path=path)
            on_done(len(answers))
        return [verdict for verdict in verdicts if verdict is not None]

    def close(self) -> None:
        """Release the workers."""
        self._workers.close()

    def __enter__(self) -> Self:
        """Return the judge."""
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """Release the workers."""
        self.close()

    def _groups(self, index: np.ndarray) -> list[np.ndarray]:
        """Return the paths of each task: paths over one scene stay together."""
        order = np.argsort(index, kind="stable")
        grain, count = self._grain, self._workers.count
        rounds = max(-(-len(index) // (grain.task * count)), 1 if grain.abreast else _TASKS_EACH)
        size = max(1, -(-len(index) // (rounds * count)))
        return [order[first : first + size] for first in range(0, len(order), size)]

    def _task(
        self,
        scenes: Sequence[Scene],
        paths: Sequence[GuidePath],
        index: np.ndarray,
        group: np.ndarray,
    ) -> _Task:
        used, local = np.unique(index[group], return_inverse=True)
        asked = AskedGuides(
            self.robot,
            tuple(scenes[each] for each in used),
            tuple(paths[each] for each in group),
            tuple(local.tolist()),
        )
        return _Task(self.planner, self.settings, asked)


def _judge_task(task: _Task) -> list[Verdict]:
    return ask(task.planner, task.asked, task.settings)


def _require_fit(scenes: int, paths: int, index: np.ndarray) -> None:
    if index.shape != (paths,):
        raise InputError(f"{paths} guide paths need as many scene indices, not {index.shape}")
    if paths and not (index.min() >= 0 and index.max() < scenes):
        wrong = int(np.flatnonzero((index < 0) | (index >= scenes))[0])
        raise InputError(
            f"guide path {wrong} is over scene {int(index[wrong])}; there are {scenes} scenes,"
            " counted from 0"
        )
