"""Gaits planned on fields that nothing was tuned on: `python -m benchmarks.gaits [PLANNER]`.

PLANNER is `search`, or a policy (policy.npz); --draws 0 has its own answers alone, whose rows are
policy_alone_... instead of planner_.... --starts N draws N starts for each kind of field,
with goals 2 to 5 m away and 150 phases at most; --confirmed N has HiGHS rebuild the programs of N
plans of each kind. Replaces the planner's rows in benchmarks/results/gaits.json; with --held-out it
prints only, from fields for tuning.
"""

import argparse
import sys
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from benchmarks.contacts.rows import Row
from benchmarks.gait_starts import starts_on
from benchmarks.measurements import others, this_machine, write_measurements
from jaxleas.cli_guard import run_guarded
from jaxleas.dynamics import Discretisation, margins_by_definition
from jaxleas.envs.gait_planning import (
    GaitPlanningConfig,
    Ground,
    PlanningState,
)
from jaxleas.files import policy_path
from jaxleas.gaits import (
    Gait,
    Retries,
    footing_of,
    search_crawls,
    taken,
    transitions_along,
    walk_policy,
)
from jaxleas.terrain import FIELD_KINDS
from jaxleas.training import Policy, read_policy

OUT = Path(__file__).resolve().parents[1] / "benchmarks/results/gaits.json"
AT_ONCE, PHASES = 25, 150
TARGET = {"random_stairs": 95.0, "temple": 95.0}
"""This project's own targets [%]; 98 elsewhere."""


@dataclass(frozen=True)
class Judged:
    """What became of the starts on one kind of field.

    Attributes:
        gaits: ways, one for each start.
        seconds: time for each [s].
    """

    gaits: Sequence[Gait]
    seconds: float

    @property
    def reached(self) -> float:
        """Share that reached the goal [%]."""
        return 100.0 * float(np.mean([each.ending == "reached" for each in self.gaits]))


def main(arguments: Sequence[str]) -> None:
    """Judge the planner and write its rows."""
    given = _parser().parse_args(arguments)
    machine, measured = this_machine(), []
    for row in _rows(given):
        measured.append(row.measurement(machine))
        print(f"{row.name}: {measured[-1].value} {row.unit}", flush=True)
    if not given.held_out:
        write_measurements(OUT, [*others(OUT, measured), *measured])


def _rows(given: argparse.Namespace) -> Iterator[Row]:
    title = _title(given)
    seconds, confirmed, programs = [], 0, 0
    for kind in FIELD_KINDS:
        judged, config = _judge(given, kind)
        seconds.append(judged.seconds)
        limit = TARGET.get(kind, 98.0)
        yield Row(f"{title}_{kind}_success", "%", [judged.reached], None, limit, "higher")
        found = [each for each in judged.gaits if each.ending == "reached"][: given.confirmed]
        for gait in found:
            margins = _margins(config, gait)
            confirmed += int((margins >= config.least_margin - 1e-6).sum())
            programs += len(margins)
    if programs:
        share = 100.0 * confirmed / programs
        yield Row(f"{title}_confirmed", "%", [share], None, 100.0, "higher")
    yield Row(f"{title}_seconds", "s", seconds)


def _title(given: argparse.Namespace) -> str:
    if given.planner == "search":
        return "search"
    return "planner" if given.draws else "policy_alone"


def _judge(given: argparse.Namespace, kind: str) -> tuple[Judged, GaitPlanningConfig]:
    policy = None
    if given.planner != "search":
        policy = read_policy(policy_path(given.planner), of=GaitPlanningConfig)
    config = GaitPlanningConfig() if policy is None else policy.config
    ground, starts = starts_on(config, kind, 4 * given.starts, given.starts, given.held_out)
    count = len(starts.step)
    begin = time.perf_counter()
    footing = footing_of(config, ground)
    gaits: list[Gait] = []
    for place in range(0, count, AT_ONCE):
        some = taken(starts, slice(place, place + AT_ONCE))
        if policy is None:
            gaits += search_crawls(config, footing, some)
        else:
            gaits += _walked(policy, ground, some, given.draws)
        print(f"{kind}: {len(gaits)} of {count}", file=sys.stderr, flush=True)
    return Judged(gaits, (time.perf_counter() - begin) / count), config


def _walked(policy: Policy, ground: Ground, starts: PlanningState, draws: int) -> list[Gait]:
    one = [taken(starts, slice(row, row + 1)) for row in range(len(starts.step))]
    return [walk_policy(policy, ground, start, PHASES, Retries(draws)).gait for start in one]


def _margins(config: GaitPlanningConfig, gait: Gait) -> np.ndarray:
    """Return the margins of a way's programs, by HiGHS from their definition."""
    transitions = transitions_along(config, gait.states.phase, gait.commands.times)
    return margins_by_definition(transitions, Discretisation(instants=config.instants))


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.gaits", description=__doc__)
    parser.add_argument("planner", nargs="?", default="search")
    parser.add_argument("--starts", type=int, default=100)
    parser.add_argument("--draws", type=int, default=Retries.draws)
    parser.add_argument("--confirmed", type=int, default=20)
    parser.add_argument("--held-out", action="store_true")
    return parser


if __name__ == "__main__":
    sys.exit(run_guarded(lambda: main(sys.argv[1:])))
