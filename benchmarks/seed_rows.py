"""The worst of several seeds as rows of a benchmark file."""

from collections.abc import Mapping, Sequence
from typing import Any

from benchmarks.measurements import Better, Measurement

Cell = Mapping[str, Any]
"""Cell of a suite with the numbers of every seed, as `benchmarks.seeds.cells_of` returns it."""

CROSSED = ("transitions", "hole", "wall", "circuit")
"""Suites whose goals must be reached."""


def rows_of_cells(cells: Sequence[Cell], machine: str) -> list[Measurement]:
    """Return the rows: of each seed its worst cell [%], and as the value the worst seed's.

    Suites that were not judged have no row.

    Args:
        cells: cells with the numbers of every seed.
        machine: machine that they were trained on.
    """
    rows = [_row(f"{suite}_worst", "success", _of(cells, suite)) for suite in CROSSED]
    for yaw in (0, 180):
        turned = [cell for cell in _of(cells, "dead_end") if cell["yaw"] == yaw]
        rows.append(_row(f"dead_end_{yaw}_worst_invalid", "invalid", turned))
    for yaw in (0, 180):
        noisy = [cell for cell in _of(cells, "transitions_noise") if cell["yaw"] == yaw]
        rows.append(_row(f"noise_{yaw}_worst", "success", noisy))
    limits = _of(cells, "limits")
    crossable = [cell for cell in limits if cell["expectation"] == "cross"]
    rows.append(_row("limits_worst_invalid", "invalid", limits))
    rows.append(_row("limits_crossable_worst", "success", crossable))
    return [row.model_copy(update={"machine": machine}) for row in rows if row is not None]


def _of(cells: Sequence[Cell], suite: str) -> list[Cell]:
    return [cell for cell in cells if cell["suite"] == suite]


def _row(name: str, number: str, cells: Sequence[Cell]) -> Measurement | None:
    if not cells:
        return None
    better: Better = "higher" if number == "success" else "lower"
    worst = min if better == "higher" else max
    seeds = [cell["seeds"] for cell in cells]
    runs = [100.0 * worst(each[seed][number] for each in seeds) for seed in seeds[0]]
    return Measurement(
        name=name,
        value=round(worst(runs), 4),
        unit="%",
        better=better,
        runs=tuple(round(each, 4) for each in runs),
        machine="",
        rival=None,
        ratio=None,
        limit=None,
        of_limit=None,
    )
