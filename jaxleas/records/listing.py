"""Runs as a table."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from jaxleas.records.record import RunRecord
from jaxleas.reports import align, percent

HEADINGS = (
    "run",
    "state",
    "begun",
    "steps",
    "held out",
    "success",
    "time",
    "revision",
    "configuration",
)
LEFT = ("run", "state", "begun", "revision", "configuration")
LEAST = 24
"""Minimum width of the configuration's column."""


def table(records: Sequence[RunRecord], folder: Path, width: int) -> str:
    """Return runs as a table for a terminal, with the problems of damaged runs.

    Args:
        records: runs in the order to be shown.
        folder: folder that was searched; the runs' names are relative to it.
        width: width of the terminal, to which configurations are cut.
    """
    rows = [_row(record, folder) for record in records]
    used = sum(max(map(len, column)) + 2 for column in zip(HEADINGS, *rows, strict=True)) - 2
    room = max(LEAST, width - used + max(len(row[-1]) for row in [HEADINGS, *rows]))
    lines = align([HEADINGS, *[(*row[:-1], cut(row[-1], room)) for row in rows]], LEFT)
    problems = [record.problem for record in records if record.state == "damaged"]
    return "\n".join([*lines, *([""] if problems else []), *problems])


def cut(text: str, width: int) -> str:
    """Return a text cut to a width, with ... where something was left out."""
    return text if len(text) <= width else text[: max(width - 4, 0)].rstrip() + " ..."


def as_text(value: Any) -> str:
    """Return a value of a configuration as a user writes it."""
    if isinstance(value, list | tuple):
        return f"[{', '.join(map(as_text, value))}]"
    if isinstance(value, bool) or value is None:
        return {True: "true", False: "false", None: "null"}[value]
    if isinstance(value, int) and abs(value) >= 10_000:
        return f"{value:_}"
    return f"{value:g}" if isinstance(value, float) else str(value)


def duration(seconds: float | None) -> str:
    """Return a time in hours and minutes, or in minutes and seconds."""
    if seconds is None:
        return "-"
    minutes, rest = divmod(round(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    if hours:
        return f"{hours} h {minutes:02d} min"
    return f"{minutes} min {rest:02d} s" if minutes else f"{rest} s"


def as_json(record: RunRecord) -> Mapping[str, Any]:
    """Return a run as plain values, without its metrics."""
    return {
        "path": str(record.path),
        "state": record.state,
        "problem": record.problem or None,
        "created": record.created,
        "source": record.source,
        "steps": record.steps,
        "total_steps": record.total,
        "held_out": record.held_out,
        "success": record.success,
        "evaluations": {
            suite: {f"{cell.name} {cell.yaw:g}": cell.success for cell in record.cells(suite)}
            for suite in record.evaluations
        },
        "seconds": record.seconds,
        "revision": record.revision,
        "differences": record.differences,
    }


def _row(record: RunRecord, folder: Path) -> tuple[str, ...]:
    inside = record.path.relative_to(folder) if record.path.is_relative_to(folder) else record.path
    differences = [f"{key}={as_text(value)}" for key, value in record.differences.items()]
    return (
        record.path.name if inside == Path(".") else str(inside),
        record.state,
        "-" if record.created is None else record.created[:16].replace("T", " "),
        _steps(record),
        percent(record.held_out),
        percent(record.success),
        duration(record.seconds),
        record.revision or "-",
        " ".join([record.source or "-", *differences]),
    )


def _steps(record: RunRecord) -> str:
    done = _millions(record.steps)
    whole = record.total is None or record.steps >= record.total
    return done if whole else f"{done} of {_millions(record.total or 0)}"


def _millions(steps: int) -> str:
    return f"{steps / 1e6:.2f} M"
