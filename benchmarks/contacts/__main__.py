"""Measure the exact contact planners, and draw the thesis's figures from the measurements.

python -m benchmarks.contacts PART ... [--reference FILE --polytopes FILE] [--patience S]

Each part replaces its own figures in benchmarks/results/contacts.json; sets and sets_reference, of
the search over sets of places, in benchmarks/results/multicontact.json.
"""

import argparse
import os
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path

from benchmarks.contacts.course import with_and_without_guide
from benchmarks.contacts.pictures import draw_all
from benchmarks.contacts.reference import on_reference, sets_on_reference
from benchmarks.contacts.rows import Row
from benchmarks.contacts.samples import against_samples_and_step
from benchmarks.contacts.sets import without_guide
from benchmarks.measurements import others, read_measurements, this_machine, write_measurements
from jaxleas.cli_guard import UsageError, run_guarded

ROOT = Path(__file__).resolve().parents[2]
OUT, IMAGES = ROOT / "benchmarks/results/contacts.json", ROOT / "docs/images"
OUT_OF_SETS = ROOT / "benchmarks/results/multicontact.json"
REFERENCE, SETS = ("reference", "sets_reference"), ("sets", "sets_reference")
PARTS = ("reference", "course", "samples", "pictures", *SETS)


def main(arguments: Sequence[str]) -> None:
    """Measure the selected parts."""
    given = _parser().parse_args(arguments)
    asking = [part for part in REFERENCE if part in given.parts]
    if asking and not (given.reference and given.polytopes):
        raise UsageError(f"the part {asking[0]} needs --reference and --polytopes")
    for part in given.parts:
        machine = this_machine()
        if os.getloadavg()[0] > (os.cpu_count() or 1):
            machine += ", under load"
        out = given.out or (OUT_OF_SETS if part in SETS else OUT)
        if part == "pictures":
            draw_all(IMAGES, read_measurements(out))
            continue
        measured = []
        for row in _rows(part, given):
            measured.append(row.measurement(machine))
            print(f"{row.name}: {measured[-1].value} {row.unit}", flush=True)
        write_measurements(out, [*others(out, measured), *measured])


def _rows(part: str, given: argparse.Namespace) -> Iterator[Row]:
    if part == "reference":
        return on_reference(given.reference, given.polytopes)
    if part == "sets":
        return without_guide(given.patience)
    if part == "sets_reference":
        return sets_on_reference(given.reference, given.polytopes)
    if part == "course":
        return with_and_without_guide(given.patience)
    return against_samples_and_step(given.guides)


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks.contacts", description="Measure the exact contact planners."
    )
    add = parser.add_argument
    add("parts", nargs="+", choices=PARTS)
    add("--reference", type=Path, help="contact-problems.jsonl.gz")
    add("--polytopes", type=Path, help="talos-polytopes.json")
    add("--patience", type=float, default=40.0, help="for a plan without guide [s]")
    add("--guides", type=int, default=10, help="up the stairs, a seed")
    add("--out", type=Path, help="the file of figures, by default the part's own")
    return parser


if __name__ == "__main__":
    sys.argv[0] = "benchmarks.contacts"  # as which errors are reported
    sys.exit(run_guarded(lambda: main(sys.argv[1:])))
