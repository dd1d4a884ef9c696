"""Metrics of a run: one JSON object a line, and the same numbers for all who watch."""

import json
import math
import sys
import time
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from types import TracebackType
from typing import Any, Self

from jaxleas.files import write_text
from jaxleas.training.watching import Audience, Status, open_watchers
from jaxleas.types.errors import InputError


class MetricsLog:
    """Appends to `metrics.jsonl` in a run folder, and tells the same to all who watch.

    Append a step's metrics *before* saving its checkpoint: a run killed between the two then
    repeats the step, and its lines end the same as those of a run never killed. Only the wall time,
    key "seconds", differs.

    Args:
        folder: the run folder.
        truncate_after_step: when resuming, the step resumed from: later lines are dropped.
        watch: watchers, by name; they never stop or slow a training.
        config: of the run, as plain values, for the watchers.
        say: told a sentence about a watcher that fails.

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
            kept = [line for line, row in _rows(self.path) if row["step"] <= truncate_after_step]
        write_text(self.path, "".join(kept))
        spent = json.loads(kept[-1])["seconds"] if kept else 0.0
        self._start = time.monotonic() - spent
        self._stream = self.path.open("a", encoding="utf-8")
        self._audience = Audience(watchers, say)
        self._audience.begin(config or {}, name_of(Path(folder)), truncate_after_step)

    def append(self, step: int, metrics: Mapping[str, float]) -> None:
        """Write one line; a number that is not finite is written as null.

        Args:
            step: training steps done.
            metrics: by name; a slash groups them.

        Raises:
            InputError: the file cannot be written (disk full).
        """
        numbers = {name: float(value) for name, value in metrics.items()}
        row = {"step": int(step), "seconds": round(time.monotonic() - self._start, 3)}
        row |= {name: value if math.isfinite(value) else None for name, value in numbers.items()}
        try:
            self._stream.write(json.dumps(row, allow_nan=False) + "\n")
            self._stream.flush()  # into the kernel: survives the death of this process
        except OSError as error:
            raise InputError(f"cannot write {self.path}: {error.strerror or error}") from error
        self._audience.row(int(step), numbers)

    def close(self, status: Status = "finished") -> None:
        """Close the file; give the watchers a moment to finish."""
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
    """Return the name of a run for people: its folder, seen from here if it lies below."""
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
        InputError: the file is missing, or another line of it is no row.
    """
    if not Path(path).is_file():
        raise InputError(f"{path} does not exist: the run has logged nothing yet")
    return [row for _, row in _rows(Path(path))]


def _rows(path: Path) -> list[tuple[str, dict[str, Any]]]:
    """Return each whole line, as it is and parsed."""
    try:
        lines = path.read_text(encoding="utf-8").splitlines(keepends=True) if path.is_file() else []
        whole = [line for line in lines if line.endswith("\n")]
        rows = [(line, json.loads(line)) for line in whole]
        if all({"step", "seconds"} <= row.keys() for _, row in rows):
            return rows
    except (OSError, ValueError, AttributeError) as error:
        raise InputError(f"{path} cannot be read: {error}") from error
    raise InputError(f"{path} is damaged: a line lacks `step` or `seconds`")
