"""A side-by-side comparison, written cell by cell, so that an interrupted one can continue."""

import time
from collections.abc import Callable, Mapping
from contextlib import ExitStack
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from jaxleas.contacts import PlannerSettings
from jaxleas.evaluation.contenders import Contenders
from jaxleas.evaluation.exact import Bookkeeping, ResultKey, judge_exact, result_key
from jaxleas.evaluation.examination import Candidate, kept_evaluation
from jaxleas.evaluation.forecast import Forecast
from jaxleas.evaluation.result_file import CellResult, Evaluation, now, write_evaluation
from jaxleas.evaluation.suites import Cell, Suite
from jaxleas.labels import Judge, planner_workers

Results = dict[ResultKey, CellResult]
_SAME = ("suite", "seed", "robot", "scale", "conditions", "foresight")
"""What must agree before results of one evaluation count in another."""


@dataclass(frozen=True)
class Planning:
    """How exact planners are asked.

    Attributes:
        planners: names of the exact planners; without any, the walks alone are counted.
        settings: settings of the planners, by name; their defaults where not given.
        processes: number of processes that plan at the same time.
    """

    planners: tuple[str, ...]
    settings: Mapping[str, PlannerSettings] = field(default_factory=dict)
    processes: int = 1


def compare(
    candidate: Candidate,
    contenders: Contenders,
    suite: Suite,
    planning: Planning,
    *,
    file: Path | None = None,
    say: Callable[[str], None] = lambda text: None,
) -> Evaluation:
    """Judge methods side by side on a suite by exact planners.

    Args:
        candidate: policy to judge; its environment draws the starts.
        contenders: methods that walk.
        suite: suite to be walked.
        planning: exact planners that judge.
        file: file written after every cell. Results that it already holds for the same policies,
            suite, starts, seed and planner settings are kept, and not judged again.
        say: callable that shows progress.

    Returns:
        All results, including those of the file.
    """
    workers = planner_workers(planning.processes)
    with ExitStack() as stack:
        stack.callback(workers.close)
        robot = candidate.env.config.robot
        judges = {
            name: Judge(name, planning.settings.get(name), workers=workers, robot=robot)
            for name in planning.planners
        }
        head = _head(candidate, contenders, suite, judges)
        before = None if file is None else kept_evaluation(file, candidate)
        sheet = _Sheet(head, suite, file, before)
        asked: tuple[str | None, ...] = planning.planners or (None,)
        forecast = Forecast(suite, len(contenders.methods), asked, say)
        for key in sheet.results:
            if key[4] in contenders.methods and key[5] in asked:
                forecast.skip(sheet.cells[key[:4]], key[5])

        def keep(result: CellResult) -> None:
            sheet.add(result)
            forecast.result(sheet.cells[result_key(result)[:4]], result.planner)

        judge_exact(
            candidate.env,
            contenders.methods,
            suite,
            judges,
            bookkeeping=Bookkeeping(dict(sheet.results), keep, forecast.guides),
        )
        return sheet.evaluation()


class _Sheet:
    """The results so far, and the file that holds them."""

    def __init__(
        self, head: Evaluation, suite: Suite, file: Path | None, before: Evaluation | None
    ) -> None:
        self.begin, self.file = time.perf_counter(), file
        self.cells: dict[tuple[str, float, float, float], Cell] = {
            cell.key: cell for cell in suite.cells
        }
        self.head, self.results = (
            (head, {}) if before is None else _merged(before, head, self.cells)
        )
        self._latest: Evaluation | None = None
        self.earlier = (before.seconds or 0.0) if before is not None and self.results else 0.0

    def add(self, result: CellResult) -> None:
        """Take in a result; from now on the file holds it."""
        self.results[result_key(result)] = result
        self._latest = None
        if self.file is not None:
            write_evaluation(self.file, self.evaluation())

    def evaluation(self) -> Evaluation:
        """Return all results in the order of the suite's cells; cached until one is added."""
        if self._latest is not None:
            return self._latest
        seconds = round(self.earlier + time.perf_counter() - self.begin, 2)
        ordered = tuple(
            result for cell in self.cells for key, result in self.results.items() if key[:4] == cell
        )
        changes = {"cells": ordered, "seconds": seconds, "created": now()}
        self._latest = self.head.model_copy(update=changes)
        return self._latest


def side_by_side_file(run: Path, suite: Suite) -> Path:
    """Return where a run folder keeps a comparison: one file per suite, start count and seed."""
    starts = suite.cells[0].starts
    return run / "evaluation" / f"side_by_side_{suite.name}_{starts}_seed{suite.seed}.json"


def _head(
    candidate: Candidate, contenders: Contenders, suite: Suite, judges: Mapping[str, Judge]
) -> Evaluation:
    """Return an evaluation without results, which describes what they will be about."""
    return Evaluation(
        suite=suite.name,
        policy=str(candidate.path),
        fingerprint=candidate.fingerprint,
        policies=dict(contenders.fingerprints),
        planners={name: judge.settings.model_dump(mode="json") for name, judge in judges.items()},
        **candidate.terms.describe(),
        guard=candidate.env.config.guard,
        robot=candidate.env.config.robot,
        scale=suite.scale,
        seed=suite.seed,
        created=now(),
        cells=(),
    )


def _merged(
    before: Evaluation, head: Evaluation, cells: Mapping[tuple[str, float, float, float], Cell]
) -> tuple[Evaluation, Results]:
    """Return the file's results that a new judgement would only repeat, and a head for both.

    What the file knows of policies and planners that are not requested now stays in it.
    """
    if any(getattr(before, name) != getattr(head, name) for name in _SAME):
        return head, {}
    results: Results = {}
    for result in before.cells:
        key = result_key(result)
        changed = _differ(before.policies, head.policies, result.method) or (
            result.planner is not None and _differ(before.planners, head.planners, result.planner)
        )
        if key[:4] in cells and cells[key[:4]].starts == result.starts and not changed:
            results[key] = result
    both = {
        "policies": before.policies | head.policies,
        "planners": before.planners | head.planners,
    }
    return head.model_copy(update=both), results


def _differ(before: Mapping[str, Any], now: Mapping[str, Any], name: str) -> bool:
    return name in now and before.get(name) != now[name]
