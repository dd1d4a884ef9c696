"""Gaits planned on fields that nothing was tuned on: `python -m benchmarks.gaits [PLANNER]`.

PLANNER is `search`, or a policy (policy.npz). --starts N draws N starts for each kind of field,
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

import jax
import numpy as np

from benchmarks.contacts.rows import Row
from benchmarks.measurements import read_measurements, this_machine, write_measurements
from jaxleas.cli_guard import run_guarded
from jaxleas.dynamics import Discretisation, margins_by_definition, one_of
from jaxleas.envs.gait_planning import (
    GaitPlanning,
    GaitPlanningConfig,
    GaitWorldsConfig,
    Ground,
    PlanningState,
    Shares,
    transitions_of,
)
from jaxleas.gaits import Gait, footing_of, search_crawls, walk_policy
from jaxleas.terrain import EVALUATION_SEED, FIELD_KINDS, TUNING_SEED
from jaxleas.training import Policy, read_policy

OUT = Path(__file__).resolve().parents[1] / "benchmarks/results/gaits.json"
FIELDS, AT_ONCE, PHASES = 20, 25, 150
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
        names = {each.name for each in measured}
        before = read_measurements(OUT) if OUT.is_file() else []
        write_measurements(OUT, [*(each for each in before if each.name not in names), *measured])


def _rows(given: argparse.Namespace) -> Iterator[Row]:
    title = "search" if given.planner == "search" else "planner"
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


def _judge(given: argparse.Namespace, kind: str) -> tuple[Judged, GaitPlanningConfig]:
    policy = (
        None if given.planner == "search" else read_policy(given.planner, of=GaitPlanningConfig)
    )
    config = GaitPlanningConfig() if policy is None else policy.config
    shares = {name: float(name == kind) for name in FIELD_KINDS}
    task = GaitPlanning(config, GaitWorldsConfig(shares=Shares(**shares)))
    first = (TUNING_SEED if given.held_out else EVALUATION_SEED) + FIELDS * FIELD_KINDS.index(kind)
    ground = task.make_world(range(first, first + FIELDS), True)
    drawn = task.draw_starts(ground, np.random.default_rng(first), 4 * given.starts, True)
    valid = np.flatnonzero(drawn.valid)[: given.starts]
    starts = jax.tree.map(lambda leaf: leaf[valid], drawn.state)
    begin = time.perf_counter()
    gaits: list[Gait] = []
    for place in range(0, len(valid), AT_ONCE):
        some = jax.tree.map(lambda leaf, at=place: leaf[at : at + AT_ONCE], starts)
        gaits += (
            _searched(config, ground, some) if policy is None else _walked(policy, ground, some)
        )
        print(f"{kind}: {len(gaits)} of {len(valid)}", file=sys.stderr, flush=True)
    return Judged(gaits, (time.perf_counter() - begin) / len(valid)), config


def _searched(config: GaitPlanningConfig, ground: Ground, starts: PlanningState) -> list[Gait]:
    return search_crawls(config, footing_of(config, ground), starts)


def _walked(policy: Policy, ground: Ground, starts: PlanningState) -> list[Gait]:
    rows = range(len(starts.step))
    one = [jax.tree.map(lambda leaf, row=row: leaf[row : row + 1], starts) for row in rows]
    return [walk_policy(policy, ground, start, PHASES).gait for start in one]


def _margins(config: GaitPlanningConfig, gait: Gait) -> np.ndarray:
    """Return the margins of a way's programs, by HiGHS from their definition."""
    before, after = (
        jax.tree.map(lambda leaf, part=part: leaf[part], gait.states.phase)
        for part in (slice(None, -1), slice(1, None))
    )
    transitions = transitions_of(config, before, after, gait.commands.times)
    where = Discretisation(instants=config.instants)
    rows = range(len(gait.commands.times))
    return np.array([float(margins_by_definition(one_of(transitions, row), where)) for row in rows])


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.gaits", description=__doc__)
    parser.add_argument("planner", nargs="?", default="search")
    parser.add_argument("--starts", type=int, default=100)
    parser.add_argument("--confirmed", type=int, default=20)
    parser.add_argument("--held-out", action="store_true")
    return parser


if __name__ == "__main__":
    sys.exit(run_guarded(lambda: main(sys.argv[1:])))
