"""Starts from which robots cross courses, and their success as a row."""

from collections.abc import Sequence
from dataclasses import dataclass

from benchmarks.contacts.rows import Row
from benchmarks.quadruped.walks import Crossed

SUCCESS, UNSAFE = 100.0, 2.0  # this project's own targets [%]


@dataclass(frozen=True)
class Starts:
    """Starts on each course.

    Attributes:
        count: number of starts.
        seed: seed of their draws.
    """

    count: int
    seed: int


def shown(name: str, found: Crossed) -> Crossed:
    """Print what became of robots on a course, and return it."""
    print(f"{name}: {found.endings}\n{found.counts.in_words()}", flush=True)
    return found


def success(name: str, found: Sequence[Crossed], limit: float | None = None) -> Row:
    """Return the share of robots that stand at the goal.

    Args:
        name: name of the row.
        found: what became of robots on some courses.
        limit: target of this project [%].
    """
    reached = sum(each.reached for each in found)
    total = sum(len(each.crossings) for each in found)
    return Row(name, of_starts(found), [100.0 * reached / total], limit=limit, better="higher")


def of_starts(found: Sequence[Crossed]) -> str:
    """Return the unit of a share of all starts."""
    return f"% of {sum(len(each.crossings) for each in found)} starts"
