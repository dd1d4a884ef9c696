"""Metrics, measured figures, and the JSON file that holds them."""

import math
import platform
import statistics
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal, Self

import jax
from pydantic import ValidationError

from jaxleas.configuration import Strict
from jaxleas.files import read_json, write_json
from jaxleas.training import cores
from jaxleas.types import InputError

Better = Literal["higher", "lower"]


@dataclass(frozen=True)
class Metric:
    """One line of the table.

    Attributes:
        name: name, which begins with env_, ppo_, learn_, export_ or walk_.
        unit: unit of the value.
        better: direction of better values.
        tolerance: relative difference from the baseline that is not significant.
        quick: whether `--quick` measures it, too.
    """

    name: str
    unit: str
    better: Better = "higher"
    tolerance: float = 0.10
    quick: bool = True


@dataclass(frozen=True)
class Figure:
    """The measured values of a metric.

    Attributes:
        runs: one value per run; None for a run that never got there.
        limit: limit of the hardware, in the metric's unit; None if unknown.
        rival: value of the rival, in the metric's unit; None if not measured.
    """

    runs: Sequence[float | None]
    limit: float | None = None
    rival: float | None = None


class Measurement(Strict):
    """One entry of a benchmark file."""

    name: str
    value: float | None
    """Median of the runs, or the worst where the name says so; null if half of them never got
    there."""
    unit: str
    better: Better
    runs: tuple[float | None, ...]
    machine: str
    rival: float | None
    """The rival's figure for the same metric."""
    ratio: float | None
    """Number of times better than the rival: above 1 is better, whatever the direction."""
    limit: float | None
    """Limit of the hardware."""
    of_limit: float | None
    """Fraction of the limit that is reached, at most 1 if the limit is a bound."""

    @classmethod
    def of(cls, metric: Metric, figure: Figure, machine: str) -> Self:
        """Return the entry for a figure: its median, ratio and fraction."""
        value = median(figure.runs, metric.better)
        return cls(
            name=metric.name,
            value=_rounded(value),
            unit=metric.unit,
            better=metric.better,
            runs=tuple(_rounded(run) for run in figure.runs),
            machine=machine,
            rival=_rounded(figure.rival),
            ratio=_rounded(_times_better(value, figure.rival, metric.better)),
            limit=_rounded(figure.limit),
            of_limit=_rounded(_times_better(value, figure.limit, metric.better)),
        )


def median(runs: Sequence[float | None], better: Better) -> float | None:
    """Return the median; a run that never got there counts as the worst."""
    worst = -math.inf if better == "higher" else math.inf
    value = statistics.median([worst if run is None else run for run in runs])
    return value if math.isfinite(value) else None


def write_measurements(path: str | Path, measurements: Sequence[Measurement]) -> None:
    """Write a benchmark file, whole or not at all."""
    write_json(path, [each.model_dump(mode="json") for each in measurements])


def others(path: str | Path, measured: Sequence[Measurement]) -> list[Measurement]:
    """Return what a benchmark file holds besides some measurements; nothing without a file.

    Args:
        path: path of the file.
        measured: measurements that are to take the places of those of their names.
    """
    names = {each.name for each in measured}
    before = read_measurements(path) if Path(path).is_file() else []
    return [each for each in before if each.name not in names]


def read_measurements(path: str | Path) -> list[Measurement]:
    """Read a benchmark file.

    Raises:
        InputError: the file is missing or not a list, or a key of an entry is missing or unusable;
            the message names it.
    """
    content = read_json(path)
    if not isinstance(content, list):
        raise InputError(f"{path} is no benchmark file: it needs a list of measurements")
    measurements = []
    for index, entry in enumerate(content):
        try:
            measurements.append(Measurement.model_validate(entry))
        except ValidationError as error:
            first = error.errors()[0]
            key = ".".join(map(str, first["loc"])) or "entry"
            raise InputError(f"{path}: entry {index}: {key}: {first['msg']}") from error
    return measurements


def merge(
    measurements: Sequence[Measurement], into: Sequence[Measurement], order: Sequence[str]
) -> list[Measurement]:
    """Replace measurements of the same names, and keep the others.

    Args:
        measurements: new measurements.
        into: old measurements.
        order: order of names; other names come last.
    """
    places = {name: place for place, name in enumerate(order)}
    merged = {each.name: each for each in (*into, *measurements)}
    return sorted(merged.values(), key=lambda each: places.get(each.name, len(places)))


def this_machine() -> str:
    """Return a description of this machine: processor, cores and other devices."""
    name = platform.processor() or platform.machine()
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
        name = next(line.split(":", 1)[1].strip() for line in lines if line.startswith("model n"))
    except (OSError, StopIteration):
        pass
    kinds = [each.device_kind for each in jax.devices() if each.platform != "cpu"]
    devices = "".join(f"; {kinds.count(kind)} x {kind}" for kind in sorted(set(kinds)))
    return f"{name}, {cores()} cores{devices}"


def _times_better(value: float | None, other: float | None, better: Better) -> float | None:
    if not value or not other:
        return None
    return value / other if better == "higher" else other / value


def _rounded(value: float | None) -> float | None:
    return None if value is None else float(f"{value:.5g}")
