"""Measure contacts planned on noisy height maps, and the time that finding surfaces takes.

python -m benchmarks.maps PART ... [--paths N] [--noises N] [--held-out] [--processes N] [--inset X]

With --inset the figures end in _inset: plans on surfaces drawn in that far. Each part replaces its
own figures in benchmarks/results/maps.json.
"""

import argparse
import sys
from collections.abc import Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path

from benchmarks.contacts.rows import Row
from benchmarks.maps.plans import Judgement, judged
from benchmarks.maps.speed import planes_seconds
from benchmarks.maps.walks import KINDS, Walk, walks
from benchmarks.measurements import Measurement, read_measurements, this_machine, write_measurements
from jaxleas.cli_guard import run_guarded

OUT = Path(__file__).resolve().parents[2] / "benchmarks/results/maps.json"
PARTS = (*KINDS, "speed")
WORST = "map_foot_error_worst"
TOGETHER = 10  # walks on one terrain
SHARE, ERROR, SECONDS = 97.0, 0.02, 1.0  # this project's own targets [%], [m], [s]


def main(arguments: Sequence[str]) -> None:
    """Measure the selected parts."""
    given = _parser().parse_args(arguments)
    machine = this_machine()
    for part in given.parts:
        rows = _speed() if part == "speed" else _plans(part, given)
        measured = []
        for row in rows:
            measured.append(row.measurement(machine))
            print(f"{row.name}: {measured[-1].value} {row.unit} {list(row.runs)}", flush=True)
        if not given.held_out:
            names = {each.name for each in measured}
            before = read_measurements(given.out) if given.out.is_file() else []
            kept = [each for each in before if each.name not in {*names, WORST}]
            write_measurements(given.out, with_worst([*kept, *measured], machine))


def with_worst(measured: list[Measurement], machine: str) -> list[Measurement]:
    """Return measurements with the worst foot of all kinds, in each run."""
    kinds = [each.runs for each in measured if each.name.startswith(f"{WORST}_")]
    if not kinds:
        return measured
    runs = [max(each for each in run if each is not None) for run in zip(*kinds, strict=True)]
    return [*measured, Row(WORST, "m", runs, limit=ERROR).measurement(machine)]


def _speed() -> Iterator[Row]:
    yield Row("planes_seconds", "s", planes_seconds(5), limit=SECONDS)


def _plans(kind: str, given: argparse.Namespace) -> Iterator[Row]:
    """Yield share of plans, worst foot and soles over edges; a run is a seed of the noise."""
    asked = walks(kind, given.paths, given.held_out)
    with ProcessPoolExecutor(given.processes, mp_context=get_context("spawn")) as pool:
        true = _judged(pool, asked, None)
        allowed = [number for number, each in enumerate(true) if each.planned]
        runs, shares = [], []
        print(
            f"{kind}: {len(allowed)} of {len(asked)} guide paths can be planned on the true scene"
        )
        for seed in range(given.noises):
            runs.append(_judged(pool, asked, seed, given.inset))
            good = sum(runs[-1][each].good for each in allowed)
            shares.append(100.0 * good / len(allowed))
            print(f"{kind}: noise {seed}, {good} can be planned on the map", flush=True)
    end = kind if given.inset is None else f"{kind}_inset"
    limits = (SHARE, ERROR) if given.inset is None else (None, None)
    yield Row(f"map_plans_{end}", "%", shares, limit=limits[0], better="higher")
    worst = [max(each.worst for each in run) for run in runs]
    yield Row(f"{_name_of_worst(given.inset)}_{kind}", "m", worst, limit=limits[1])
    over = [_over(run) for run in runs]
    yield Row(f"map_soles_over_edges_{end}", "%", over, rival=_over(true))


def _name_of_worst(inset: float | None) -> str:
    return WORST if inset is None else "map_inset_foot_error_worst"


def _judged(
    pool: ProcessPoolExecutor,
    asked: Sequence[Walk],
    seed: int | None,
    inset: float | None = None,
) -> list[Judgement]:
    count = len(asked)
    return list(pool.map(judged, asked, [seed] * count, [inset] * count, chunksize=TOGETHER))


def _over(run: Sequence[Judgement]) -> float:
    """Return the share of feet with a corner of the sole over an edge [%]."""
    return 100.0 * sum(each.over for each in run) / max(sum(each.feet for each in run), 1)


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.maps", description=__doc__)
    add = parser.add_argument
    add("parts", nargs="+", choices=PARTS)
    add("--paths", type=int, default=200, help="number of guide paths of a kind")
    add("--noises", type=int, default=3, help="number of seeds of the noise")
    add("--held-out", action="store_true", help="on terrain for tuning; nothing is written")
    add("--inset", type=float, help="draw surfaces in this far [m]; by default as far as users do")
    add("--processes", type=int, default=2, help="number of processes that plan")
    add("--out", type=Path, default=OUT)
    return parser


if __name__ == "__main__":
    sys.argv[0] = "benchmarks.maps"  # as which errors are reported
    sys.exit(run_guarded(lambda: main(sys.argv[1:])))
