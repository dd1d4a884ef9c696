"""Progress of a sweep: one redrawn line in a terminal, plain lines elsewhere."""

import os
import sys
import time
from typing import TextIO

from jaxleas.sweeps.border import Sweep
from jaxleas.sweeps.results import TrialResult, best_of, shown_value


class SweepProgress:
    """Display of trials done, trials running, the best so far, and the time left.

    Args:
        sweep: sweep that is conducted.
        stream: stream to write to; standard error by default.
    """

    def __init__(self, sweep: Sweep, stream: TextIO | None = None) -> None:
        self._sweep = sweep
        self._stream = sys.stderr if stream is None else stream
        plain = not self._stream.isatty() or any(map(os.environ.get, ("CI", "NO_COLOR")))
        self._begin, self._end = ("", "\n") if plain else ("\r\x1b[K", "")
        self._start = time.monotonic()
        self._before: int | None = None
        self._line = ""

    def __call__(self, results: list[TrialResult], running: int) -> None:
        """Show the progress."""
        if self._before is None:
            self._before = len(results)  # of an earlier session: they do not count for the speed
        line = self._describe(results, running)
        if line != self._line:
            self._line = line
            self._stream.write(f"{self._begin}{line}{self._end}")
            self._stream.flush()

    def close(self) -> None:
        """End the line."""
        if not self._end and self._line:
            self._stream.write("\n")

    def _describe(self, results: list[TrialResult], running: int) -> str:
        config = self._sweep.config
        parts = [f"{len(results)} of {config.trials} trials", f"{running} running"]
        counts = [(state, sum(r.state == state for r in results)) for state in ("pruned", "failed")]
        parts += [f"{count} {state}" for state, count in counts if count]
        front = best_of(results, config.objectives)
        if front:
            total = float(self._sweep.base.ppo.updates * self._sweep.base.ppo.batch)
            shown = [
                shown_value(one, front[0].values[one.name], total) for one in config.objectives
            ]
            parts.append(f"best {', '.join(shown)} (trial {front[0].number})")
        return "  ".join([*parts, f"{self._left(len(results))} left"])

    def _left(self, done: int) -> str:
        now = done - (self._before or 0)
        if now <= 0:
            return "?"
        each = (time.monotonic() - self._start) / now
        minutes, seconds = divmod(round(each * (self._sweep.config.trials - done)), 60)
        hours, minutes = divmod(minutes, 60)
        return f"{hours}:{minutes:02d}:{seconds:02d}" if hours else f"{minutes}:{seconds:02d}"
