"""Rows of robots whose footsteps are planned at each contact."""

from collections.abc import Callable, Iterator, Sequence
from types import MappingProxyType

from benchmarks.contacts.rows import Row
from benchmarks.quadruped.starts import SUCCESS, UNSAFE, Starts, of_starts, shown, success
from benchmarks.quadruped.walks import Crossed, crossed, crossed_in_turn, worst_unsafe
from jaxleas.crossing import make_course

STAIRS = ("stairs_1", "stairs_2", "stairs_3")
GAPS = ("gaps_1", "gaps_2", "gaps_12cm", "gaps_16cm")
WAYPOINTS, QUICK = "waypoints", "trot_quick"
HIGH, IN_TURN = "stairs_high", ("trot", "trot_high")
NOISY = 90.0  # this project's own target [%]


def stairs(starts: Starts) -> Iterator[Row]:
    """Yield success, unsafe landings of the worst foot of the worst stairs, and wrong pairs."""
    found = _crossed(starts, STAIRS)
    yield success("stairs_success", found, SUCCESS)
    yield Row("stairs_unsafe_worst", of_starts(found), [worst_unsafe(found)], limit=UNSAFE)
    yield Row("wrong_pair", of_starts(found), [max(each.counts.wrong_share for each in found)])


def gaps(starts: Starts) -> Iterator[Row]:
    """Yield success over gaps, together and on each course."""
    found = [_crossed(starts, [name]) for name in GAPS]
    yield success("gaps_success", [each for one in found for each in one], SUCCESS)
    for name, one in zip(GAPS, found, strict=True):
        yield success(f"gaps_success_{name}", one, SUCCESS)


def noisy(starts: Starts) -> Iterator[Row]:
    """Yield success where each robot's map is noisy and shifted."""
    course = make_course(STAIRS[0])
    found = [shown(course.name, crossed(course, starts.count, starts.seed, noisy=True))]
    yield success("noisy_success", found, NOISY)


def waypoints(starts: Starts) -> Iterator[Row]:
    """Yield success and unsafe landings along waypoints."""
    found = _crossed(starts, [WAYPOINTS])
    yield success("waypoints_success", found, SUCCESS)
    yield Row("waypoints_unsafe_worst", of_starts(found), [worst_unsafe(found)])


def quick(starts: Starts) -> Iterator[Row]:
    """Yield the figures of one course that a controller with another cycle and touchdown walks."""
    course = make_course(STAIRS[0])
    walked = crossed(course, starts.count, starts.seed, controller=QUICK)
    found = [shown(f"{course.name}, {QUICK}", walked)]
    yield success(f"{course.name}_success_{QUICK}", found, SUCCESS)
    unsafe = f"{course.name}_unsafe_worst_{QUICK}"
    yield Row(unsafe, of_starts(found), [worst_unsafe(found)], limit=UNSAFE)


def in_turn(starts: Starts) -> Iterator[Row]:
    """Yield success where a controller of high swings takes over, and how rarely it does."""
    course = make_course(HIGH)
    found = [shown(HIGH, crossed_in_turn(course, starts.count, starts.seed, IN_TURN))]
    yield success("stairs_high_success", found, SUCCESS)
    yield Row("stairs_high_unsafe_worst", of_starts(found), [worst_unsafe(found)])
    high = IN_TURN[1]
    yield Row("stairs_high_share", f"% of footsteps by {high}", [found[0].share_of(high)])
    alone = shown(f"{HIGH}, {IN_TURN[0]} alone", crossed(course, starts.count, starts.seed))
    yield success("stairs_high_success_low_alone", [alone])


def _crossed(starts: Starts, names: Sequence[str]) -> list[Crossed]:
    return [shown(name, crossed(make_course(name), starts.count, starts.seed)) for name in names]


PLANNED: MappingProxyType[str, Callable[[Starts], Iterator[Row]]] = MappingProxyType(
    {
        "stairs": stairs,
        "gaps": gaps,
        "noisy": noisy,
        "waypoints": waypoints,
        "quick": quick,
        "in_turn": in_turn,
    }
)
"""Parts of the benchmark by name."""
