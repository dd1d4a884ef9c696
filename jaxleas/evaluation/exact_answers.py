"""An exact planner's answers about a cell: a verdict for each guide path, and their count."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from jaxtyping import Bool

from jaxleas.evaluation.judge import rounded, summarise
from jaxleas.evaluation.result_file import CellResult
from jaxleas.evaluation.roll_outs import CellRollOut
from jaxleas.evaluation.statistics import wilson_interval
from jaxleas.evaluation.suites import Cell
from jaxleas.terrain import Scene
from jaxleas.types import GuidePath, Verdict


class Planner(Protocol):
    """An exact planner that judges guide paths; `labels.Judge` is one."""

    def judge(
        self,
        scenes: Sequence[Scene],
        paths: Sequence[GuidePath],
        scene_index: Sequence[int],
        on_done: Callable[[int], None] = ...,
    ) -> list[Verdict]:
        """Return the verdict on each path over its scene."""
        ...


@dataclass(frozen=True)
class Judged:
    """The roll-outs of a cell, and an exact planner's verdicts on them.

    Attributes:
        roll_outs: roll-outs of the cell.
        verdicts: one verdict per roll-out; None where the goal was not reached: there is no guide
            path to plan along.
    """

    roll_outs: CellRollOut
    verdicts: tuple[Verdict | None, ...]

    @property
    def planned(self) -> Bool[np.ndarray, " N"]:
        """Whether the goal was reached and the planner found contacts for the whole guide path."""
        return np.array([each is not None and each.success for each in self.verdicts], dtype=bool)


def ask(
    cell: Cell,
    walked: CellRollOut,
    planner: Planner,
    time_step: float,
    on_done: Callable[[int], None] = lambda count: None,
) -> Judged:
    """Ask an exact planner about every guide path that reached its goal.

    Args:
        cell: cell that was walked.
        walked: roll-outs of the cell.
        planner: planner that judges.
        time_step: time between two configurations [s].
        on_done: callable that is given the number of guide paths judged since the last call.
    """
    numbers = np.flatnonzero(walked.reached).tolist()
    verdicts: list[Verdict | None] = [None] * len(walked.reached)
    if numbers:
        answers = planner.judge(
            [scenario.scene for scenario in cell.scenarios],
            [walked.guide_path(number, time_step) for number in numbers],
            [int(walked.starts.scene[number]) for number in numbers],
            on_done,
        )
        for number, answer in zip(numbers, answers, strict=True):
            verdicts[number] = answer
    return Judged(walked, tuple(verdicts))


def summarise_plans(
    cell: Cell, method: str, planner: str, judged: Judged, time_step: float
) -> CellResult:
    """Count a cell's plans: `planned` is their share of all starts, not of those that arrived.

    Args:
        cell: cell that was walked.
        method: name of the method.
        planner: name of the planner.
        judged: roll-outs and the planner's verdicts.
        time_step: time between two configurations [s].
    """
    result = summarise(cell, method, judged.roll_outs, time_step)
    good = [each for each in judged.verdicts if each is not None and each.success]
    late = [each for each in judged.verdicts if each is not None and not each.decided]
    robustness = [each.mean_robustness for each in good if each.mean_robustness is not None]
    steps = [each.mean_step for each in good if each.mean_step is not None]
    plans = {
        "planner": planner,
        "planned": rounded(len(good) / cell.starts),
        "undecided": rounded(len(late) / cell.starts),
        "robustness": rounded(np.mean(robustness)) if robustness else None,
        "mean_step": rounded(np.mean(steps)) if steps else None,
    }
    if cell.expectation == "cross":
        low, high = wilson_interval(len(good), cell.starts)
        plans |= {"low": rounded(low), "high": rounded(high)}
    return CellResult.model_validate(result.model_dump() | plans)
