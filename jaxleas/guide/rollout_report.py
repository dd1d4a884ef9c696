"""What `jaxleas rollout` says of its walks."""

from collections import Counter
from pathlib import Path

from jaxleas.guide.reconfirming import Walked

MOST_LINES = 20
"""Number of failures that are printed; the file holds all of them."""


def describe_walks(walked: Walked, exactly: bool) -> str:
    """Return how the walks ended, in one sentence.

    Args:
        walked: walks.
        exactly: whether they were judged on the terrain's polygons, too.
    """
    count = Counter(walked.reasons)
    alone = {
        "the exact conditions": walked.refused(),
        "the height map": walked.mistaken(),
    }
    words = ", ".join(f"{number} by {judge} alone" for judge, number in alone.items() if number)
    apart = f" ({words})" if exactly and words else ""
    return (
        f"of {len(walked.paths)} queries {count['reached']} reached their goal,"
        f" {count['invalid']} ended invalid{apart}, {count['stopped']} stopped before it"
    )


def failure_lines(walked: Walked, out: Path) -> list[str]:
    """Return a line for each invalid walk: what failed, where and by how much.

    Args:
        walked: walks.
        out: file that holds all of the failures.
    """
    lines = [
        f"query {number}: {failure.at(path)}"
        for number, (path, failure) in enumerate(zip(walked.paths, walked.failures, strict=True))
        if failure is not None
    ]
    more = len(lines) - MOST_LINES
    return [*lines[:MOST_LINES], *([f"and {more} more: 'failed' in {out}"] if more > 0 else [])]
