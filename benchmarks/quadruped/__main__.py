"""Measure a quadruped over stairs, gaps and waypoints, planned at each contact and blind.

python -m benchmarks.quadruped PART ... [--starts N] [--held-out]

Parts: stairs, gaps, noisy, waypoints, quick (stairs_1 by trot_quick), in_turn (high steps by two
controllers), stairs_blind, gaps_blind, waypoints_blind, plans (times, from starts for tuning),
proposal (the shipped one in the planner's place), models, which needs --scores of `jaxleas gait
fit`, and public, which needs the folder of the public footsteps as --public. Each part replaces its
own figures in benchmarks/results/quadruped.json.
"""

import argparse
import sys
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

from benchmarks.contacts.rows import Row
from benchmarks.measurements import read_measurements, this_machine, write_measurements
from benchmarks.quadruped.models import model_rows
from benchmarks.quadruped.plans import plan_rows
from benchmarks.quadruped.proposals import planned_before, proposal_rows
from benchmarks.quadruped.public import public_rows
from benchmarks.quadruped.walks import (
    Crossed,
    crossed,
    crossed_blind,
    crossed_in_turn,
    worst_unsafe,
)
from jaxleas.cli_guard import run_guarded
from jaxleas.crossing import make_course
from jaxleas.terrain import EVALUATION_SEED, HELD_OUT_SEED
from jaxleas.types import InputError

OUT = Path(__file__).resolve().parents[2] / "benchmarks/results/quadruped.json"
STAIRS = ("stairs_1", "stairs_2", "stairs_3")
GAPS = ("gaps_1", "gaps_2", "gaps_12cm", "gaps_16cm")
WAYPOINTS, QUICK = "waypoints", "trot_quick"
HIGH, IN_TURN = "stairs_high", ("trot", "trot_high")
BLIND_GAPS = ("gaps_16cm", "gaps_20cm")
BLIND_STAIRS_SPEED = 0.4
BLIND_SPEEDS = (0.2, 0.4, 0.6, 0.8, 1.0)
UNSAFE, SUCCESS, NOISY = 2.0, 100.0, 90.0  # this project's own targets [%]


def main(arguments: Sequence[str]) -> None:
    """Measure the selected parts."""
    given = _parser().parse_args(arguments)
    machine = this_machine()
    for part in given.parts:
        measured = []
        for row in PARTS[part](given):
            measured.append(row.measurement(machine))
            print(f"{row.name}: {measured[-1].value} {row.unit} {list(row.runs)}", flush=True)
        if not given.held_out:
            names = {each.name for each in measured}
            before = read_measurements(given.out) if given.out.is_file() else []
            kept = [each for each in before if each.name not in names]
            write_measurements(given.out, [*kept, *measured])


def _stairs(given: argparse.Namespace) -> Iterator[Row]:
    """Yield success, unsafe landings of the worst foot of the worst stairs, and wrong pairs."""
    found = _crossed(given, STAIRS)
    yield _success("stairs_success", found, SUCCESS)
    yield Row("stairs_unsafe_worst", _starts(found), [worst_unsafe(found)], limit=UNSAFE)
    yield Row("wrong_pair", _starts(found), [max(each.counts.wrong_share for each in found)])


def _gaps(given: argparse.Namespace) -> Iterator[Row]:
    found = [_crossed(given, [name]) for name in GAPS]
    yield _success("gaps_success", [each for one in found for each in one], SUCCESS)
    for name, one in zip(GAPS, found, strict=True):
        yield _success(f"gaps_success_{name}", one, SUCCESS)


def _noisy(given: argparse.Namespace) -> Iterator[Row]:
    found = [_shown("stairs_1", crossed(make_course("stairs_1"), *_count(given), noisy=True))]
    yield _success("noisy_success", found, NOISY)


def _waypoints(given: argparse.Namespace) -> Iterator[Row]:
    found = _crossed(given, [WAYPOINTS])
    yield _success("waypoints_success", found, SUCCESS)
    yield Row("waypoints_unsafe_worst", _starts(found), [worst_unsafe(found)])


def _waypoints_blind(given: argparse.Namespace) -> Iterator[Row]:
    found = [_shown(WAYPOINTS, crossed_blind(make_course(WAYPOINTS), *_count(given), BLIND_SPEEDS))]
    yield _success("waypoints_blind_success", found, None)
    yield Row("waypoints_blind_unsafe_worst", _starts(found), [worst_unsafe(found)])


def _quick(given: argparse.Namespace) -> Iterator[Row]:
    """Yield the figures of one course that a controller with another cycle and touchdown walks."""
    course = make_course(STAIRS[0])
    found = [_shown(f"{STAIRS[0]}, {QUICK}", crossed(course, *_count(given), controller=QUICK))]
    yield _success(f"{STAIRS[0]}_success_{QUICK}", found, SUCCESS)
    yield Row(
        f"{STAIRS[0]}_unsafe_worst_{QUICK}", _starts(found), [worst_unsafe(found)], limit=UNSAFE
    )


def _in_turn(given: argparse.Namespace) -> Iterator[Row]:
    """Yield success where a controller of high swings takes over, and how rarely it does."""
    found = [_shown(HIGH, crossed_in_turn(make_course(HIGH), *_count(given), IN_TURN))]
    yield _success("stairs_high_success", found, SUCCESS)
    yield Row("stairs_high_unsafe_worst", _starts(found), [worst_unsafe(found)])
    yield Row(
        "stairs_high_share", f"% of footsteps by {IN_TURN[1]}", [found[0].share_of(IN_TURN[1])]
    )
    alone = [_shown(f"{HIGH}, {IN_TURN[0]} alone", crossed(make_course(HIGH), *_count(given)))]
    yield _success("stairs_high_success_low_alone", alone, None)


def _stairs_blind(given: argparse.Namespace) -> Iterator[Row]:
    speeds = (BLIND_STAIRS_SPEED,)
    found = [
        _shown(name, crossed_blind(make_course(name), *_count(given), speeds)) for name in STAIRS
    ]
    yield _success("stairs_blind_success", found, None)
    yield Row("stairs_blind_unsafe_worst", _starts(found), [worst_unsafe(found)])


def _gaps_blind(given: argparse.Namespace) -> Iterator[Row]:
    found = [
        _shown(name, crossed_blind(make_course(name), *_count(given), BLIND_SPEEDS))
        for name in BLIND_GAPS
    ]
    yield _success("gaps_blind_success", found, None)
    for name, one in zip(BLIND_GAPS, found, strict=True):
        yield _success(f"gaps_blind_success_{name}", [one], None)


def _plans(given: argparse.Namespace) -> Iterator[Row]:
    yield from plan_rows((*STAIRS, *GAPS), given.starts)


def _proposal(given: argparse.Namespace) -> Iterator[Row]:
    parts = {"stairs_success": len(STAIRS), "gaps_success": len(GAPS)}
    planned = planned_before(given.out, {name: n * given.starts for name, n in parts.items()})
    yield from proposal_rows((*STAIRS, *GAPS), *_count(given), planned, _shown)


def _models(given: argparse.Namespace) -> Iterator[Row]:
    if given.scores is None:
        raise InputError("models: give --scores, the scores.json of jaxleas gait fit")
    yield from model_rows(given.scores)


def _public(given: argparse.Namespace) -> Iterator[Row]:
    if given.public is None:
        raise InputError("public: give --public, the folder that holds sim_footsteps.npz")
    yield from public_rows(given.public)


def _crossed(given: argparse.Namespace, names: Sequence[str]) -> list[Crossed]:
    return [_shown(name, crossed(make_course(name), *_count(given))) for name in names]


def _count(given: argparse.Namespace) -> tuple[int, int]:
    """Return number and seed of the starts."""
    return given.starts, HELD_OUT_SEED if given.held_out else EVALUATION_SEED


def _shown(name: str, found: Crossed) -> Crossed:
    print(f"{name}: {found.endings}\n{found.counts.in_words()}", flush=True)
    return found


def _success(name: str, found: Sequence[Crossed], limit: float | None) -> Row:
    reached = sum(each.reached for each in found)
    total = sum(len(each.crossings) for each in found)
    return Row(name, _starts(found), [100.0 * reached / total], limit=limit, better="higher")


def _starts(found: Sequence[Crossed]) -> str:
    return f"% of {sum(len(each.crossings) for each in found)} starts"


PARTS: dict[str, Callable[[argparse.Namespace], Iterator[Row]]] = {
    "stairs": _stairs,
    "gaps": _gaps,
    "noisy": _noisy,
    "waypoints": _waypoints,
    "quick": _quick,
    "in_turn": _in_turn,
    "stairs_blind": _stairs_blind,
    "gaps_blind": _gaps_blind,
    "waypoints_blind": _waypoints_blind,
    "plans": _plans,
    "proposal": _proposal,
    "models": _models,
    "public": _public,
}


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.quadruped", description=__doc__)
    add = parser.add_argument
    add("parts", nargs="+", choices=PARTS)
    add("--starts", type=int, default=10, help="number of starts")
    add("--held-out", action="store_true", help="starts for tuning; nothing is written")
    add("--scores", type=Path, help="scores.json of jaxleas gait fit")
    add("--public", type=Path, help="folder of the public footsteps of 2023")
    add("--out", type=Path, default=OUT)
    return parser


if __name__ == "__main__":
    sys.argv[0] = "benchmarks.quadruped"  # as which errors are reported
    sys.exit(run_guarded(lambda: main(sys.argv[1:])))
