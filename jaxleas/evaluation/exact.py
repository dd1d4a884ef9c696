"""Guide paths judged by exact contact planners: the numbers that count (T 4.3, 5.2.4)."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from jaxleas.contacts import PlannerSettings
from jaxleas.envs.steering import SteeringEnv
from jaxleas.evaluation.contender import Contender, contender
from jaxleas.evaluation.exact_answers import Planner, ask, summarise_plans
from jaxleas.evaluation.exactly import judged_exactly
from jaxleas.evaluation.judge import summarise
from jaxleas.evaluation.result_file import CellResult
from jaxleas.evaluation.starts import Grounds, draw_starts, make_grounds
from jaxleas.evaluation.suited import suited
from jaxleas.evaluation.suites import Cell, Suite
from jaxleas.guide import leas, read_steering_policy
from jaxleas.labels import Judge

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


def judge_exact(
    env: SteeringEnv,
    contenders: Mapping[str, Contender],
    suite: Suite,
    planners: Mapping[str, Planner],
    *,
    bookkeeping: Bookkeeping | None = None,
    grounds: Grounds | None = None,
) -> list[CellResult]:
    """Walk a suite with every method and let every exact planner judge the same guide paths.

    Args:
        env: steering task: draws the starts (the same for all), and gives the time step.
        contenders: contenders by the name that results carry; `contender` makes one from a steering
            method.
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
        for method, roll_out in contenders.items():
            walked = None
            for planner in planners or (None,):
                result = bookkeeping.known.get((*cell.key, method, planner))
                if result is None:
                    starts = starts or draw_starts(env, grounds, cell, suite.stream())
                    bookkeeping.on_guides(cell, method, planner, 0)
                    if walked is None:
                        walked = roll_out(grounds, starts, suite.steps_of(cell))
                        walked = judged_exactly(env.robot, cell, walked)
                    if planner is None:
                        result = summarise(cell, method, walked, time_step)
                    else:
                        count = _counter(bookkeeping.on_guides, cell, method, planner)
                        judged = ask(cell, walked, planners[planner], time_step, count)
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
    contenders = {"policy": contender(env, leas(env, found))}
    with Judge(planner, settings, robot=found.config.robot) as judge:
        shares = [
            cell.planned or 0.0
            for suite in suites
            for cell in judge_exact(env, contenders, suited(suite, env.robot), {planner: judge})
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
