"""What `jaxleas rollout` says of its paths."""

from collections import Counter
from collections.abc import Sequence
from pathlib import Path

from jaxleas.guide.reconfirming import EndedPaths
from jaxleas.terrain import HeightMap
from jaxleas.types import Query

MOST_LINES = 20
"""Number of failures that are printed; the file holds all of them."""
MOST_NUMBERS = 5


def describe_paths(walked: EndedPaths, exactly: bool) -> str:
    """Return how the paths ended, in one sentence.

    Args:
        walked: paths that were walked, and how each ended.
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


def failure_lines(walked: EndedPaths, out: Path) -> list[str]:
    """Return a line for each invalid walk: what failed, where and by how much.

    Args:
        walked: paths that were walked, and how each ended.
        out: file that holds all of the failures.
    """
    lines = [
        f"query {number}: {failure.at(path)}"
        for number, (path, failure) in enumerate(zip(walked.paths, walked.failures, strict=True))
        if failure is not None
    ]
    more = len(lines) - MOST_LINES
    return [*lines[:MOST_LINES], *([f"and {more} more: 'failed' in {out}"] if more > 0 else [])]


def goals_off_the_map(queries: Sequence[Query], terrain: HeightMap) -> list[str]:
    """Return a line on the goals that no path can reach, as they lie off the map; or no line.

    Args:
        queries: queries that were walked.
        terrain: height map that was walked on.
    """
    x_min, x_max, y_min, y_max = terrain.extent
    off = [
        number
        for number, query in enumerate(queries)
        if not (x_min <= query.goal[0] <= x_max and y_min <= query.goal[1] <= y_max)
    ]
    if not off:
        return []
    first = ", ".join(map(str, off[:MOST_NUMBERS])) + (", ..." if len(off) > MOST_NUMBERS else "")
    return [
        f"off the map, which spans x in [{x_min:g}, {x_max:g}] and y in [{y_min:g}, {y_max:g}] m,"
        f" lie the goals of {len(off)} queries: {first}"
    ]
