"""Progress of a training: a live line in a terminal, a plain line now and then elsewhere."""

import os
import sys
import time
from collections.abc import Mapping
from types import TracebackType
from typing import Self, TextIO

import rich.console
import rich.progress


class Progress:
    """Display of steps done, steps per second, further measures, and the time left.

    In a terminal one line is redrawn in place. Without one, or with CI or NO_COLOR set, a plain
    line is written every `every_seconds`, and one at the end.

    Args:
        total: total number of training steps.
        start: number of steps done before (when resuming).
        every_seconds: pause between plain lines [s].
        stream: stream to write to; standard error by default.
        unit: what a step is called.
    """

    def __init__(
        self,
        total: int,
        start: int = 0,
        every_seconds: float = 10.0,
        stream: TextIO | None = None,
        unit: str = "steps",
    ) -> None:
        self._unit = unit
        self.total = max(total, 1)
        self._done = start
        self._every_seconds = every_seconds
        self._stream = sys.stderr if stream is None else stream
        self._last = time.monotonic()
        self._last_line = self._last
        self._rate = 0.0
        self._updates = 0
        self._line = ""
        plain = not self._stream.isatty() or any(map(os.environ.get, ("CI", "NO_COLOR")))
        self._live = None if plain else self._make_live()

    def update(self, step: int, values: Mapping[str, str] | None = None) -> None:
        """Show that `step` steps are done.

        Args:
            step: total number of training steps done.
            values: further values to show, as text: {"return": "3.1", "held out": "98 %"}.
        """
        now = time.monotonic()
        rate = (step - self._done) / max(now - self._last, 1e-9)
        # Smoothed, because single updates jitter; but the first holds the compilation, so the
        # second replaces it.
        self._updates += 1
        self._rate = rate if self._updates <= 2 else 0.8 * self._rate + 0.2 * rate
        self._done, self._last = step, now
        self._line = self._describe(values or {})
        if self._live is not None:
            self._live.update(self._task, completed=step, line=self._line)
        elif now - self._last_line >= self._every_seconds:
            self._write()

    def say(self, sentence: str) -> None:
        """Write a sentence above the live line."""
        if self._live is not None:
            self._live.console.print(sentence, markup=False, highlight=False)
        else:
            print(sentence, file=self._stream, flush=True)

    def __enter__(self) -> Self:
        if self._live is not None:
            self._live.start()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        if self._live is not None:
            self._live.stop()  # restores the cursor, also after Ctrl-C
        elif self._line:
            self._write()

    def _make_live(self) -> rich.progress.Progress:
        live = rich.progress.Progress(
            rich.progress.BarColumn(bar_width=24),
            rich.progress.TextColumn("{task.fields[line]}", markup=False),
            console=rich.console.Console(file=self._stream),
            refresh_per_second=4,
        )
        self._task = live.add_task("", total=self.total, completed=self._done, line="starting")
        return live

    def _write(self) -> None:
        print(self._line, file=self._stream, flush=True)
        self._last_line, self._line = time.monotonic(), ""

    def _describe(self, values: Mapping[str, str]) -> str:
        left = (self.total - self._done) / self._rate if self._rate > 0 else float("inf")
        parts = [
            f"{100 * self._done / self.total:3.0f} %",
            f"{self._done:,} {self._unit}",
            f"{self._rate:,.0f} {self._unit}/s",
            *(f"{name} {value}" for name, value in values.items()),
            f"{_clock(left)} left",
        ]
        return "  ".join(parts)


def _clock(seconds: float) -> str:
    if seconds == float("inf"):
        return "?"
    minutes, seconds = divmod(round(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours}:{minutes:02d}:{seconds:02d}" if hours else f"{minutes}:{seconds:02d}"
