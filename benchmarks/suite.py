"""Choosing metrics by name, and measuring them."""

import difflib
from collections.abc import Callable, Sequence

from benchmarks.context import Context
from benchmarks.measurements import Measurement, Metric, this_machine
from benchmarks.workloads import WORKLOADS, Workload
from jaxleas.types import InputError


def choose(only: Sequence[str], quick: bool) -> list[Metric]:
    """Return the selected metrics.

    Args:
        only: names, or parts of names, such as `env_` or `compile`; empty for all.
        quick: leave out the slow metrics, unless only slow ones were selected.

    Raises:
        InputError: no metric has such a name.
    """
    metrics = [metric for workload in WORKLOADS for metric in workload.metrics]
    for part in only:
        if not any(part in metric.name for metric in metrics):
            raise InputError(f"no benchmark is called {part!r}{_hint(part, metrics)}")
    names = {metric.name for metric in metrics}

    def matches(part: str, name: str) -> bool:
        return part == name if part in names else part in name

    chosen = [m for m in metrics if not only or any(matches(part, m.name) for part in only)]
    fast = [metric for metric in chosen if metric.quick]
    return fast if quick and fast else chosen


def measure(
    metrics: Sequence[Metric],
    context: Context,
    tell: Callable[[str], None] = lambda _: None,
    workloads: Sequence[Workload] = WORKLOADS,
) -> list[Measurement]:
    """Measure metrics, each workload once, in the order of the catalogue.

    Args:
        metrics: metrics to measure.
        context: context of the run.
        tell: function called with a description of the current measurement.
        workloads: workloads that measure the metrics.
    """
    machine = this_machine()
    wanted = {metric.name for metric in metrics}
    measurements = []
    for workload in workloads:
        here = [metric for metric in workload.metrics if metric.name in wanted]
        if here:
            tell(", ".join(metric.name for metric in here))
            figures = workload.measure(context)
            measurements += [Measurement.of(m, figures[m.name], machine) for m in here]
    return measurements


def _hint(part: str, metrics: Sequence[Metric]) -> str:
    names = [metric.name for metric in metrics]
    prefixes = sorted({name.split("_")[0] + "_" for name in names})
    near = difflib.get_close_matches(part, [*names, *prefixes], n=1, cutoff=0.5)
    hint = f"; did you mean {near[0]}?" if near else ""
    return f"{hint} (names begin with {', '.join(prefixes)}; --list shows them)"
