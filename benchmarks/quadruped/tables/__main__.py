"""Measure the scenarios of Taouil's thesis, and write its tables and figures with our numbers.

python -m benchmarks.quadruped.tables [--courses NAME ...] [--starts N] [--page]

Each course that is not yet in benchmarks/results/quadruped_tables.json, or is named, is walked;
then docs/quadruped_tables.md and its pictures are written. With --page nothing is walked.
"""

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from benchmarks.measurements import this_machine
from benchmarks.quadruped.starts import Starts
from benchmarks.quadruped.tables.figures import draw
from benchmarks.quadruped.tables.page import FIGURES, page_of, picture_of
from benchmarks.quadruped.tables.printed import SCENARIOS
from benchmarks.quadruped.tables.walked import measure
from jaxleas.cli_guard import run_guarded
from jaxleas.crossing import make_course
from jaxleas.files import read_json, write_json, write_text
from jaxleas.terrain import EVALUATION_SEED
from jaxleas.types import InputError

ROOT = Path(__file__).resolve().parents[3]
OUT = ROOT / "benchmarks/results/quadruped_tables.json"
PAGE = ROOT / "docs/quadruped_tables.md"
COURSES = tuple(each.course for each in SCENARIOS)


def main(arguments: Sequence[str]) -> None:
    """Walk the courses that are missing or named, and write the page."""
    given = _parser().parse_args(arguments)
    found = _read(given.out)
    drawn = {course for _, course in FIGURES.values()}
    wanted = given.courses or [each for each in COURSES if each not in found["courses"]]
    for number, name in enumerate([] if given.page else wanted, start=1):
        print(f"{name}: course {number} of {len(wanted)}", flush=True)
        starts = Starts(given.starts, EVALUATION_SEED)
        found["courses"][name] = measure(make_course(name), starts, name in drawn)
        found["courses"] = {
            each: found["courses"][each] for each in COURSES if each in found["courses"]
        }
        found["machine"] = this_machine()
        write_json(given.out, found)
    missing = [each for each in COURSES if each not in found["courses"]]
    if missing:
        raise InputError(f"{given.out} has no {', '.join(missing)}: measure them first")
    write_text(PAGE, page_of(found))
    for _, course in FIGURES.values():
        walk = found["courses"][course]["walk"]
        draw(make_course(course), walk, PAGE.parent / "images" / picture_of(course))
    print(f"written to {PAGE}")


def _read(path: Path) -> dict[str, Any]:
    return read_json(path) if path.is_file() else {"version": 1, "machine": "", "courses": {}}


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks.quadruped.tables", description=__doc__
    )
    add = parser.add_argument
    add("--courses", nargs="+", choices=COURSES, help="courses to walk anew")
    add("--starts", type=int, default=10, help="number of starts")
    add("--page", action="store_true", help="write page and pictures of what was measured")
    add("--out", type=Path, default=OUT)
    return parser


if __name__ == "__main__":
    sys.argv[0] = "benchmarks.quadruped.tables"  # as which errors are reported
    sys.exit(run_guarded(lambda: main(sys.argv[1:])))
