"""How long plans take, on states that robots met while they crossed stairs and gaps."""

import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float

from benchmarks.contacts.rows import Row
from benchmarks.quadruped.walks import Crossed, crossed, planner_on
from jaxleas.crossing import WalkSettings, make_course
from jaxleas.footsteps import FootstepPlan, FootstepPlanner, Goal, WalkingState
from jaxleas.terrain import HELD_OUT_SEED

MOST = {2: 5000, 4: 1000, 8: 1000}
"""Plans that are timed at each horizon."""
LIMITS = {2: 6.0, 4: 50.0, 8: 50.0}  # this project's own targets [ms]
REPEATS = 3


@dataclass(frozen=True)
class Question:
    """What a planner was asked at a contact."""

    state: WalkingState
    goal: Goal


class Recorder:
    """A planner whose questions are kept."""

    def __init__(self, planner: FootstepPlanner, asked: list[Question]) -> None:
        self._planner, self._asked = planner, asked

    def plan(self, state: WalkingState, goal: Goal) -> FootstepPlan:
        """Keep the question, and answer it."""
        self._asked.append(Question(state, goal))
        return self._planner.plan(state, goal)


def plan_rows(courses: Sequence[str], starts: int) -> Iterator[Row]:
    """Yield the time within which 99 % of plans are found, and the gaps to the optimum.

    A run is one pass over all questions, in which each is asked once.

    Args:
        courses: names of courses that robots cross, from starts for tuning.
        starts: number of starts on each.
    """
    asked = {name: _asked_on(name, starts) for name in courses}
    for horizon, most in MOST.items():
        each = -(-most // len(asked))
        some = {name: _spread(questions, each) for name, questions in asked.items()}
        passes = [_timed(some, horizon) for _ in range(REPEATS)]
        end = "" if horizon == 2 else f"_horizon_{horizon}"
        count = len(passes[0][0])
        p99, median = (
            [1000.0 * float(np.quantile(seconds, share)) for seconds, _ in passes]
            for share in (0.99, 0.5)
        )
        yield Row(f"plan_p99{end}", f"ms, {count} plans", p99, limit=LIMITS[horizon])
        yield Row(f"plan_median{end}", f"ms, {count} plans", median)
        gaps = [float(np.quantile(gap, 0.5)) for _, gap in passes]
        yield Row(f"plan_gap_median{end}", "footsteps", gaps)


def _asked_on(name: str, starts: int) -> list[Question]:
    asked: list[Question] = []
    found: Crossed = crossed(
        make_course(name), starts, HELD_OUT_SEED, watched=lambda planner: Recorder(planner, asked)
    )
    print(f"{name}: {found.endings}; {len(asked)} plans", flush=True)
    return asked


def _spread(questions: Sequence[Question], count: int) -> list[Question]:
    """Return this many questions, or all, evenly from first to last."""
    index = np.linspace(0, len(questions) - 1, min(count, len(questions))).round().astype(int)
    return [questions[each] for each in index]


def _timed(
    asked: dict[str, list[Question]], horizon: int
) -> tuple[Float[np.ndarray, " N"], Float[np.ndarray, " N"]]:
    """Return the seconds that each plan takes, and how much cheaper one may be [footsteps]."""
    seconds, gaps = [], []
    for name, questions in asked.items():
        planner = planner_on(make_course(name), replace(WalkSettings(), horizon=horizon))
        planner.plan(questions[0].state, questions[0].goal)  # warm
        for each in questions:
            begin = time.perf_counter()
            plan = planner.plan(each.state, each.goal)
            seconds.append(time.perf_counter() - begin)
            if plan.footsteps:
                gaps.append(plan.gap)
    return np.array(seconds), np.array(gaps)
