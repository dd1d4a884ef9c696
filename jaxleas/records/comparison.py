"""Runs side by side: the differences in their configuration and origin, and their success."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from jaxleas.evaluation import wilson_interval
from jaxleas.records.record import HELD_OUT, RunRecord

MARKS = 10
"""Number of points of a learning curve in a table."""
UNTOLD = ("provenance.created", "provenance.command", "provenance.git.untracked")
"""Keys that differ from run to run and say nothing about the result."""


@dataclass(frozen=True)
class Score:
    """A measured fraction and its 95 % interval."""

    success: float
    low: float
    high: float
    starts: int


@dataclass(frozen=True)
class Comparison:
    """Runs side by side; every list has one value per run, None where a run has no value.

    Attributes:
        runs: runs that are compared.
        config: values of the configuration by dotted key, for the keys that differ.
        provenance: values of the provenance by dotted key, for the keys that differ.
        curves: held-out success by step, at some steps: that of the last examination up to the
            step.
        scores: scores by suite and cell.
    """

    runs: tuple[RunRecord, ...]
    config: Mapping[str, list[Any]]
    provenance: Mapping[str, list[Any]]
    curves: Mapping[int, list[Score | None]]
    scores: Mapping[tuple[str, str], list[Score | None]]


def compare_runs(runs: Sequence[RunRecord]) -> Comparison:
    """Compare runs side by side."""
    origins = [{f"provenance.{key}": each for key, each in run.provenance.items()} for run in runs]
    return Comparison(
        runs=tuple(runs),
        config=differing([run.config for run in runs]),
        provenance={
            key.removeprefix("provenance."): values
            for key, values in differing(origins).items()
            if key not in UNTOLD
        },
        curves=_curves(runs),
        scores=_scores(runs),
    )


def differing(values: Sequence[Mapping[str, Any]]) -> dict[str, list[Any]]:
    """Return the values of the keys that are not the same in all mappings."""
    keys = list(dict.fromkeys(key for each in values for key in each))
    found = {key: [each.get(key) for each in values] for key in keys}
    return {key: row for key, row in found.items() if any(each != row[0] for each in row)}


def apart(scores: Sequence[Score | None]) -> bool:
    """Return whether the intervals of any two scores are disjoint."""
    known = [each for each in scores if each is not None]
    return bool(known) and max(each.low for each in known) > min(each.high for each in known)


def _curves(runs: Sequence[RunRecord]) -> dict[int, list[Score | None]]:
    last = max((run.steps for run in runs), default=0)
    marks = sorted({round(last * part / MARKS) for part in range(1, MARKS + 1)}) if last else []
    return {mark: [_at(run, mark) for run in runs] for mark in marks}


def _at(run: RunRecord, step: int) -> Score | None:
    """Return the last examination of a run up to a step; None after its end."""
    examined = [row for row in run.metrics if row.get(HELD_OUT) is not None and row["step"] <= step]
    # A run that ended a little before the mark, by rounding to whole updates, still counts.
    if not examined or run.steps < 0.98 * step:
        return None
    starts = int(run.config.get("held_out.starts", 1))
    reached = float(examined[-1][HELD_OUT])
    low, high = wilson_interval(min(round(reached * starts), starts), starts)
    return Score(reached, low, high, starts)


def _scores(runs: Sequence[RunRecord]) -> dict[tuple[str, str], list[Score | None]]:
    tables = []
    for run in runs:
        tables.append(
            {
                (suite, f"{cell.name} {cell.yaw:g}°"): Score(
                    cell.success, cell.low, cell.high, cell.starts
                )
                for suite in run.evaluations
                for cell in run.cells(suite)
            }
        )
    keys = list(dict.fromkeys(key for table in tables for key in table))
    return {key: [table.get(key) for table in tables] for key in keys}
