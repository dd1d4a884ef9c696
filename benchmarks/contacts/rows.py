"""One figure of the contact planners, and the clock."""

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from benchmarks.measurements import Better, Figure, Measurement, Metric


@dataclass(frozen=True)
class Row:
    """One measured figure.

    Attributes:
        name: name, which begins with contacts_.
        unit: unit of the value.
        runs: one value per run, whose median counts; None for a run that never got there.
        rival: value of other software.
        limit: target of this project.
        better: direction of better values.
    """

    name: str
    unit: str
    runs: Sequence[float | None]
    rival: float | None = None
    limit: float | None = None
    better: Better = "lower"

    def measurement(self, machine: str) -> Measurement:
        """Return the entry of a benchmark file."""
        metric = Metric(self.name, self.unit, self.better)
        return Measurement.of(metric, Figure(self.runs, self.limit, self.rival), machine)


def milliseconds(run: Callable[[], Any], repeats: int) -> tuple[list[float], Any]:
    """Return the time of each run [ms], and the last run's result."""
    times, answer = [], None
    for _ in range(repeats):
        begin = time.perf_counter()
        answer = run()
        times.append(1000.0 * (time.perf_counter() - begin))
    return times, answer
