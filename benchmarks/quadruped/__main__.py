"""Measure a quadruped over stairs, gaps and waypoints, planned at each contact and blind.

python -m benchmarks.quadruped PART ... [--starts N] [--held-out]

Parts: stairs, gaps, noisy, waypoints, quick (stairs_1 by trot_quick), in_turn (high steps by two
controllers), stairs_blind, gaps_blind, waypoints_blind, plans (times, from starts for tuning),
proposal (the shipped one in the planner's place), models, which needs --scores and --varied of
`jaxleas gait fit`, and public, which needs the folder of the public footsteps as --public. Each
part replaces its own figures in benchmarks/results/quadruped.json.
"""

import argparse
import sys
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

from benchmarks.contacts.rows import Row
from benchmarks.measurements import others, this_machine, write_measurements
from benchmarks.quadruped.blind_rows import BLIND
from benchmarks.quadruped.models import model_rows
from benchmarks.quadruped.planned_rows import GAPS, PLANNED, STAIRS
from benchmarks.quadruped.plans import plan_rows
from benchmarks.quadruped.proposals import planned_before, proposal_rows
from benchmarks.quadruped.public import public_rows
from benchmarks.quadruped.starts import Starts, shown
from jaxleas.cli_guard import run_guarded
from jaxleas.terrain import EVALUATION_SEED, HELD_OUT_SEED
from jaxleas.types import InputError

OUT = Path(__file__).resolve().parents[2] / "benchmarks/results/quadruped.json"
WALKED = {**PLANNED, **BLIND}


def main(arguments: Sequence[str]) -> None:
    """Measure the selected parts."""
    given = _parser().parse_args(arguments)
    machine = this_machine()
    for part in given.parts:
        rows = WALKED[part](_starts(given)) if part in WALKED else OTHERS[part](given)
        measured = []
        for row in rows:
            measured.append(row.measurement(machine))
            print(f"{row.name}: {measured[-1].value} {row.unit} {list(row.runs)}", flush=True)
        if not given.held_out:
            write_measurements(given.out, [*others(given.out, measured), *measured])


def _starts(given: argparse.Namespace) -> Starts:
    return Starts(given.starts, HELD_OUT_SEED if given.held_out else EVALUATION_SEED)


def _plans(given: argparse.Namespace) -> Iterator[Row]:
    yield from plan_rows((*STAIRS, *GAPS), given.starts)


def _proposal(given: argparse.Namespace) -> Iterator[Row]:
    starts = _starts(given)
    parts = {"stairs_success": len(STAIRS), "gaps_success": len(GAPS)}
    planned = planned_before(given.out, {name: n * starts.count for name, n in parts.items()})
    yield from proposal_rows((*STAIRS, *GAPS), starts.count, starts.seed, planned, shown)


def _models(given: argparse.Namespace) -> Iterator[Row]:
    if given.scores is None or given.varied is None:
        raise InputError(
            "models: give --scores and --varied, scores.json of jaxleas gait fit: of"
            " footsteps without variations, and with them"
        )
    yield from model_rows(given.scores, given.varied)


def _public(given: argparse.Namespace) -> Iterator[Row]:
    if given.public is None:
        raise InputError("public: give --public, the folder that holds sim_footsteps.npz")
    yield from public_rows(given.public)


OTHERS: dict[str, Callable[[argparse.Namespace], Iterator[Row]]] = {
    "plans": _plans,
    "proposal": _proposal,
    "models": _models,
    "public": _public,
}


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.quadruped", description=__doc__)
    add = parser.add_argument
    add("parts", nargs="+", choices=(*WALKED, *OTHERS))
    add("--starts", type=int, default=10, help="number of starts")
    add("--held-out", action="store_true", help="starts for tuning; nothing is written")
    add("--scores", type=Path, help="scores.json of a fit to footsteps without variations")
    add("--varied", type=Path, nargs="+", help="the same of footsteps with all variations")
    add("--public", type=Path, help="folder of the public footsteps of 2023")
    add("--out", type=Path, default=OUT)
    return parser


if __name__ == "__main__":
    sys.argv[0] = "benchmarks.quadruped"  # as which errors are reported
    sys.exit(run_guarded(lambda: main(sys.argv[1:])))
