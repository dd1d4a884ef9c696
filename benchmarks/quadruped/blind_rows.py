"""Rows of robots whose controller goes straight ahead, without a map."""

from collections.abc import Callable, Iterator, Sequence
from types import MappingProxyType

from benchmarks.contacts.rows import Row
from benchmarks.quadruped.planned_rows import STAIRS, WAYPOINTS
from benchmarks.quadruped.starts import Starts, of_starts, shown, success
from benchmarks.quadruped.walks import Crossed, crossed_blind, worst_unsafe
from jaxleas.crossing import make_course

BLIND_GAPS = ("gaps_16cm", "gaps_20cm")
STAIRS_SPEEDS = (0.4,)
SPEEDS = (0.2, 0.4, 0.6, 0.8, 1.0)
"""Speeds over the largest, as the thesis has them."""


def stairs_blind(starts: Starts) -> Iterator[Row]:
    """Yield success and unsafe landings on stairs at the speed that crosses all of them."""
    found = [_crossed(name, starts, STAIRS_SPEEDS) for name in STAIRS]
    yield success("stairs_blind_success", found)
    yield Row("stairs_blind_unsafe_worst", of_starts(found), [worst_unsafe(found)])


def gaps_blind(starts: Starts) -> Iterator[Row]:
    """Yield success over wide gaps, together and on each course."""
    found = [_crossed(name, starts, SPEEDS) for name in BLIND_GAPS]
    yield success("gaps_blind_success", found)
    for name, one in zip(BLIND_GAPS, found, strict=True):
        yield success(f"gaps_blind_success_{name}", [one])


def waypoints_blind(starts: Starts) -> Iterator[Row]:
    """Yield success and unsafe landings along waypoints."""
    found = [_crossed(WAYPOINTS, starts, SPEEDS)]
    yield success("waypoints_blind_success", found)
    yield Row("waypoints_blind_unsafe_worst", of_starts(found), [worst_unsafe(found)])


def _crossed(name: str, starts: Starts, speeds: Sequence[float]) -> Crossed:
    return shown(name, crossed_blind(make_course(name), starts.count, starts.seed, speeds))


BLIND: MappingProxyType[str, Callable[[Starts], Iterator[Row]]] = MappingProxyType(
    {
        "stairs_blind": stairs_blind,
        "gaps_blind": gaps_blind,
        "waypoints_blind": waypoints_blind,
    }
)
"""Parts of the benchmark by name."""
