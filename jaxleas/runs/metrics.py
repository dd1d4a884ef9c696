"""Metrics of a run: one JSON object per line, and the same numbers for all watchers."""

import json
import logging
import math
import os
import sys
import time
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from types import TracebackType
from typing import Any, Self

from jaxleas.files import parse_json, write_text
from jaxleas.runs.watching import Audience, Status, open_watchers
from jaxleas.types import InputError

_LOG = logging.getLogger("jaxleas")


class MetricsLog:
    """Log that appends to `metrics.jsonl` in a run folder, and sends the same to all watchers.

    Append a step's metrics *before* saving its checkpoint: a run killed between the two then
    repeats the step, and its lines end up the same as those of a run that was never killed, except
    for the wall time, key "seconds".

    Args:
        folder: run folder.
        truncate_after_step: step from which a run is resumed: later lines are dropped.
        watch: names of the watchers; they never stop or slow a training.
        config: configuration of the run as plain values, for the watchers.
        say: function that is called with a sentence about a watcher that fails.

    Raises:
        InputError: the file cannot be written, or a watcher is not installed.
    """

    def __init__(
        self,
        folder: str | Path,
        truncate_after_step: int | None = None,
        watch: Sequence[str] = ("tensorboard",),
        config: Mapping[str, Any] | None = None,
        say: Callable[[str], None] = lambda sentence: print(sentence, file=sys.stderr),
    ) -> None:
        watchers = open_watchers(watch, folder)
        self.path = Path(folder) / "metrics.jsonl"
        kept: list[str] = []
        if truncate_after_step is not None:
            kept = _rows_to_keep(self.path, truncate_after_step)
        write_text(self.path, "".join(kept))
        spent = json.loads(kept[-1])["seconds"] if kept else 0.0
        self._start = time.monotonic() - spent
        self._stream = self.path.open("a", encoding="utf-8")
        self._audience = Audience(watchers, say)
        self._audience.begin(config or {}, name_of(Path(folder)), truncate_after_step)

    def append(self, step: int, metrics: Mapping[str, float]) -> None:
        """Write one line; a number that is not finite is written as null.

        Args:
            step: number of training steps done.
            metrics: metrics by name; a slash groups them.

        Raises:
            InputError: the file cannot be written (disk full).
        """
        numbers = {name: float(value) for name, value in metrics.items()}
        row = {"step": int(step), "seconds": round(time.monotonic() - self._start, 3)}
        row |= {name: value if math.isfinite(value) else None for name, value in numbers.items()}
        try:
            self._stream.write(json.dumps(row, allow_nan=False) + "\n")
            self._stream.flush()  # into the kernel, where it survives the death of this process
        except OSError as error:
            raise InputError(f"cannot write {self.path}: {error.strerror or error}") from error
        self._audience.row(int(step), numbers)

    def sync(self) -> None:
        """Write all lines to the disk; this may be called from another thread.

        Raises:
            InputError: the lines cannot be written.
        """
        try:
            os.fsync(self._stream.fileno())
        except OSError as error:
            raise InputError(f"cannot write {self.path}: {error.strerror or error}") from error

    def close(self, status: Status = "finished") -> None:
        """Close the file; wait a moment for the watchers to finish."""
        self._stream.close()
        self._audience.end(status)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close(_status(error))


def name_of(folder: Path) -> str:
    """Return the displayed name of a run: its folder, relative to the current one if inside it."""
    whole = folder.resolve()
    here = Path.cwd()
    return str(whole.relative_to(here)) if whole.is_relative_to(here) else whole.name


def _status(error: BaseException | None) -> Status:
    if error is None:
        return "finished"
    stopped = isinstance(error, KeyboardInterrupt) or getattr(error, "exit_code", None) == 130
    return "interrupted" if stopped else "failed"


def read_metrics(path: str | Path) -> list[dict[str, Any]]:
    """Return the rows of a `metrics.jsonl`, without a last line that was only half written.

    Raises:
        InputError: the file is missing, or any other line is not a row.
    """
    if not Path(path).is_file():
        raise InputError(f"{path} does not exist: the run has logged nothing yet")
    return [row for _, row in _rows(Path(path))]


def _rows_to_keep(path: Path, last_step: int) -> list[str]:
    """Return the lines up to a step; log a warning if a damaged line lost some of them."""
    rows, problem = _readable_rows(path)
    kept = [(line, row["step"]) for line, row in rows if row["step"] <= last_step]
    if problem and len(kept) == len(rows) and (not kept or kept[-1][1] < last_step):
        first = kept[-1][1] if kept else 0
        _LOG.warning("%s: the metrics of steps %d to %d are lost", problem, first, last_step)
    return [line for line, _ in kept]


def _rows(path: Path) -> list[tuple[str, dict[str, Any]]]:
    """Return each complete line, raw and parsed.

    Raises:
        InputError: a line is not a row.
    """
    rows, problem = _readable_rows(path)
    if problem:
        raise InputError(problem)
    return rows


def _readable_rows(path: Path) -> tuple[list[tuple[str, dict[str, Any]]], str]:
    """Return the complete lines before the first that is not a row, and the error in that one."""
    try:
        content = path.read_bytes() if path.is_file() else b""
    except OSError as error:
        raise InputError(f"cannot read {path}: {error.strerror or error}") from error
    rows = []
    for number, line in enumerate(content.splitlines(keepends=True), start=1):
        if not line.endswith(b"\n"):
            break  # only half written
        try:
            row = parse_json(line, f"{path}: line {number}")
        except InputError as error:
            return rows, str(error)
        if not (isinstance(row, dict) and _is_row(row)):
            return rows, (
                f"{path} is damaged: line {number} lacks `step` or `seconds`, or holds other than"
                " numbers"
            )
        rows.append((line.decode(), row))
    return rows, ""


def _is_row(row: dict[str, Any]) -> bool:
    def is_number(value: Any) -> bool:
        return isinstance(value, int | float) and not isinstance(value, bool)

    known = is_number(row.get("step")) and is_number(row.get("seconds"))
    return known and all(value is None or is_number(value) for value in row.values())
