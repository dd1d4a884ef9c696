"""Metrics of a run: one JSON object a line, and the same numbers for TensorBoard."""

import json
import math
import time
from collections.abc import Mapping
from pathlib import Path
from types import TracebackType
from typing import Any, Self

from jaxleas.files import write_text
from jaxleas.types.errors import InputError


class MetricsLog:
    """Appends to `metrics.jsonl` and `tensorboard/` in a run folder.

    Append a step's metrics *before* saving its checkpoint: a run killed between the two then
    repeats the step, and its lines end the same as those of a run never killed. Only the wall time,
    key "seconds", differs.

    Args:
        folder: the run folder.
        truncate_after_step: when resuming, the step resumed from: later lines are dropped.

    Raises:
        InputError: the file cannot be written.
    """

    def __init__(self, folder: str | Path, truncate_after_step: int | None = None) -> None:
        # Slow to import and wanted only in training.
        from tensorboardX import SummaryWriter

        self.path = Path(folder) / "metrics.jsonl"
        kept: list[str] = []
        purge = None
        if truncate_after_step is not None:
            kept = [line for line, row in _rows(self.path) if row["step"] <= truncate_after_step]
            purge = truncate_after_step + 1
        write_text(self.path, "".join(kept))
        spent = json.loads(kept[-1])["seconds"] if kept else 0.0
        self._start = time.monotonic() - spent
        self._stream = self.path.open("a", encoding="utf-8")
        self._board = SummaryWriter(
            str(Path(folder) / "tensorboard"), purge_step=purge, flush_secs=10
        )

    def append(self, step: int, metrics: Mapping[str, float]) -> None:
        """Write one line; a number that is not finite is written as null.

        Args:
            step: training steps done.
            metrics: by name; a slash groups them in TensorBoard.

        Raises:
            InputError: the file cannot be written (disk full).
        """
        numbers = {name: float(value) for name, value in metrics.items()}
        row = {"step": int(step), "seconds": round(time.monotonic() - self._start, 3)}
        row |= {name: value if math.isfinite(value) else None for name, value in numbers.items()}
        try:
            self._stream.write(json.dumps(row, allow_nan=False) + "\n")
            self._stream.flush()  # into the kernel: survives the death of this process
            for name, value in numbers.items():
                self._board.add_scalar(name, value, step)
        except OSError as error:
            raise InputError(f"cannot write {self.path}: {error.strerror or error}") from error

    def close(self) -> None:
        """Close the files."""
        self._stream.close()
        self._board.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()


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
