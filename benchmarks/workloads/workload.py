"""The definition of a workload."""

from collections.abc import Callable
from dataclasses import dataclass

from benchmarks.context import Context
from benchmarks.measurements import Figure, Metric


@dataclass(frozen=True)
class Workload:
    """Metrics that are measured together.

    Attributes:
        metrics: metrics that it measures.
        measure: function that returns a figure for each metric, by name.
    """

    metrics: tuple[Metric, ...]
    measure: Callable[[Context], dict[str, Figure]]
