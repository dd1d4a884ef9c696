"""Against the baseline: better, worse, or within what says nothing."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

from benchmarks.measurements import Measurement, Metric

Verdict = Literal["better", "worse", "within", "new"]


@dataclass(frozen=True)
class Comparison:
    """How a measurement relates to the baseline's.

    Attributes:
        verdict: result of the comparison in the metric's own direction.
        change: relative improvement; negative is worse; None where there is no number.
    """

    verdict: Verdict
    change: float | None = None


def compare(
    metric: Metric, measurement: Measurement, baseline: Mapping[str, Measurement]
) -> Comparison:
    """Compare one measurement with the baseline's of the same name, if there is one.

    A figure that is not reached any more is worse; one never reached before is better.
    """
    before = baseline.get(metric.name)
    if before is None:
        return Comparison("new")
    if measurement.value is None or before.value is None:
        if measurement.value == before.value:
            return Comparison("within")
        return Comparison("worse" if measurement.value is None else "better")
    ratio = measurement.value / before.value
    change = ratio - 1.0 if metric.better == "higher" else 1.0 / ratio - 1.0
    # A fall to 1 / (1 + t) is as large as a rise to 1 + t: the same two files, swapped.
    if change > metric.tolerance:
        return Comparison("better", change)
    if 1.0 / (1.0 + change) - 1.0 > metric.tolerance:
        return Comparison("worse", change)
    return Comparison("within", change)


def by_name(measurements: Sequence[Measurement]) -> dict[str, Measurement]:
    """Return measurements by name."""
    return {each.name: each for each in measurements}
