"""Guide paths judged by exact contact planners: the numbers that count (T 4.3, 5.2.4)."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Protocol

import numpy as np
from jaxtyping import Bool

from jaxleas.contacts import PlannerSettings
from jaxleas.envs.steering import SteeringEnv
from jaxleas.evaluation.exactly import judged_exactly
from jaxleas.evaluation.judge import CellRollOut, roll_out_cell, rounded, summarise
from jaxleas.evaluation.result_file import CellResult
from jaxleas.evaluation.starts import Grounds, Starts, draw_starts, make_grounds
from jaxleas.evaluation.statistics import wilson_interval
from jaxleas.evaluation.suited import suited
from jaxleas.evaluation.suites import Cell, Suite
from jaxleas.guide import SteeringMethod, leas, read_steering_policy
from jaxleas.labels import Judge
from jaxleas.terrain import Scene
from jaxleas.types import GuidePath, Verdict

Walker = Callable[[Grounds, Starts, int], CellRollOut]
"""Walks the starts of a cell for at most the given number of steps, with or without a roadmap."""
ResultKey = tuple[str, float, float, float, str, str | None]
"""Name, yaw, spread and speed of the cell, method, planner."""


@dataclass(frozen=True)
class Bookkeeping:
    """What is already known of an evaluation, and what is done with new results.

    Attributes:
        known: results that exist already; the questions they answer are not asked again.
        on_result: callable that is given each new result at once.
        on_guides: callable that is given cell, method, planner and number of guide paths judged.
    """

    known: Mapping[ResultKey, CellResult] = field(default_factory=dict)
    on_result: Callable[[CellResult], None] = lambda result: None
    on_guides: Callable[[Cell, str, str | None, int], None] = lambda *_: None


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


def walker(env: SteeringEnv, method: SteeringMethod) -> Walker:
    """Return a steering method that observes through its own environment as a walker."""
    return lambda grounds, starts, steps: roll_out_cell(env, grounds, method, starts, steps)


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


def judge_exact(
    env: SteeringEnv,
    walkers: Mapping[str, Walker],
    suite: Suite,
    planners: Mapping[str, Planner],
    *,
    bookkeeping: Bookkeeping | None = None,
    grounds: Grounds | None = None,
) -> list[CellResult]:
    """Walk a suite with every method and let every exact planner judge the same guide paths.

    Args:
        env: steering task: draws the starts (the same for all), and gives the time step.
        walkers: walkers by the name that results carry; `walker` makes one from a steering method.
        suite: suite to be walked.
        planners: exact planners by name; without any, the walks alone are counted.
        bookkeeping: known results, and what is done with new ones; by default nothing.
        grounds: height maps of the suite's scenes, if already made.

    Returns:
        One result for each cell, method and planner, in that order.
    """
    bookkeeping = Bookkeeping() if bookkeeping is None else bookkeeping
    grounds = make_grounds(suite.cells) if grounds is None else grounds
    time_step = env.config.limits.time_step
    results = []
    for cell in suite.cells:
        starts = None
        for method, walks in walkers.items():
            walked = None
            for planner in planners or (None,):
                result = bookkeeping.known.get((*cell.key, method, planner))
                if result is None:
                    starts = starts or draw_starts(env, grounds, cell, suite.stream())
                    bookkeeping.on_guides(cell, method, planner, 0)
                    if walked is None:
                        walked = walks(grounds, starts, suite.steps_of(cell))
                        walked = judged_exactly(env.robot, cell, walked)
                    if planner is None:
                        result = summarise(cell, method, walked, time_step)
                    else:
                        told = _counter(bookkeeping.on_guides, cell, method, planner)
                        judged = ask(cell, walked, planners[planner], time_step, told)
                        result = summarise_plans(cell, method, planner, judged, time_step)
                    bookkeeping.on_result(result)
                results.append(result)
    return results


def exact_success(
    policy: Path, planner: str, settings: PlannerSettings, suites: Sequence[Suite]
) -> float:
    """Return the mean share of starts that reach their goal with contacts all the way.

    Args:
        policy: file of a steering policy.
        planner: name of the exact planner.
        settings: settings of the planner.
        suites: suites to be walked, in published sizes; they are scaled to the policy's robot.
    """
    found = read_steering_policy(policy)
    env = SteeringEnv(found.config.under_standard_conditions())
    walkers = {"policy": walker(env, leas(env, found))}
    with Judge(planner, settings, robot=found.config.robot) as judge:
        shares = [
            cell.planned or 0.0
            for suite in suites
            for cell in judge_exact(env, walkers, suited(suite, env.robot), {planner: judge})
        ]
    return sum(shares) / len(shares)


def result_key(result: CellResult) -> ResultKey:
    """Return what distinguishes a result from the others of its evaluation."""
    cell = (result.name, result.yaw, result.yaw_spread, result.speed)
    return (*cell, result.method, result.planner)


def _counter(
    on_guides: Callable[[Cell, str, str | None, int], None], cell: Cell, method: str, planner: str
) -> Callable[[int], None]:
    return lambda count: on_guides(cell, method, planner, count)
