"""Outlines of regions: straight edges through the sides of cells (Douglas and Peucker 1973)."""

import numpy as np
from jaxtyping import Float, Int

WIGGLE = 2.0
"""Distance of an outline from a straight edge that may come from the cells alone [cells]."""
NEARLY_PARALLEL = 0.2
"""Sine of the angle between two edges below which their lines meet too far away."""
SMALL = 12
"""Number of sides below which a ring wiggles less: it is a hole of few cells."""
FAR_CORNER = 1.5
"""Farthest distance from the outline at which two edges may meet [cells]."""


def outline(ring: Int[np.ndarray, "N 2"], inset: float) -> Float[np.ndarray, "V 2"]:
    """Return the corners of the polygon whose straight edges fit a ring of cells.

    The edges are lines of least squares through the middles of the sides of cells, so that a
    slanted edge is known more finely than by a cell; they are then moved inwards.

    Args:
        ring: corners of cells, the region to the left [cells].
        inset: length by which the edges are moved to the left [cells].
    """
    middles = 0.5 * (ring + np.roll(ring, -1, axis=0))
    bends = _bends(ring, min(WIGGLE, len(ring) / SMALL))
    count = len(bends)
    if count < 3:
        return np.zeros((0, 2))
    starts, ways = np.empty((count, 2)), np.empty((count, 2))
    for edge, first in enumerate(bends):
        span = (bends[(edge + 1) % count] - first) % len(middles)
        some = middles[(first + np.arange(span)) % len(middles)]
        starts[edge], ways[edge] = _line(some, ring[bends[(edge + 1) % count]] - ring[first])
    starts += inset * np.stack([-ways[:, 1], ways[:, 0]], axis=1)
    before = np.arange(count) - 1
    return _corners(ring[bends].astype(float), starts[before], ways[before], starts, ways, inset)


def _bends(points: Int[np.ndarray, "N 2"], wiggle: float) -> list[int]:
    """Return the points between which a closed line is straight up to its wiggles."""
    count = len(points)
    first = int(np.argmax(((points - points.mean(axis=0)) ** 2).sum(axis=1)))
    second = int(np.argmax(((points - points[first]) ** 2).sum(axis=1)))
    if first == second:
        return []
    kept, open_ = {first, second}, [(first, second), (second, first)]
    while open_:
        low, high = open_.pop()
        index = (low + np.arange((high - low) % count + 1)) % count
        gaps = _gaps(points[index])
        worst = int(np.argmax(gaps))
        if gaps[worst] > wiggle:
            middle = int(index[worst])
            kept.add(middle)
            open_ += [(low, middle), (middle, high)]
    return _without_needless(points, sorted(kept), wiggle)


def _without_needless(points: np.ndarray, bends: list[int], wiggle: float) -> list[int]:
    """Drop bends without which the line is straight, too: the first two may lie anywhere."""
    at = 0
    while at < len(bends) and len(bends) > 3:
        low, high = bends[at - 1], bends[(at + 1) % len(bends)]
        index = (low + np.arange((high - low) % len(points) + 1)) % len(points)
        if _gaps(points[index]).max() <= wiggle:
            bends.pop(at)
            at = max(at - 1, 0)
        else:
            at += 1
    return bends


def _gaps(points: Float[np.ndarray, "N 2"]) -> Float[np.ndarray, " N"]:
    """Return distances from the straight line between the first point and the last."""
    way = points[-1] - points[0]
    length = np.hypot(*way)
    rest = points - points[0]
    if length < 1e-9:
        return np.hypot(rest[:, 0], rest[:, 1])
    return np.abs(rest[:, 0] * way[1] - rest[:, 1] * way[0]) / length


def _line(points: Float[np.ndarray, "N 2"], way: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return a point and the direction of the line of least squared distances through points.

    Args:
        points: points that lie about on a line.
        way: vector from its beginning to its end.
    """
    if len(points) > 4:
        points = points[1:-1]  # at the ends the outline turns
    if len(points) < 2:
        return points[0], way / np.hypot(*way)
    middle = points.mean(axis=0)
    x, y = (points - middle).T
    angle = 0.5 * np.arctan2(2.0 * (x @ y), x @ x - y @ y)
    fitted = np.array([np.cos(angle), np.sin(angle)])
    return middle, fitted if fitted @ way >= 0.0 else -fitted


def _corners(
    bends: np.ndarray,
    start: np.ndarray,
    way: np.ndarray,
    next_start: np.ndarray,
    next_way: np.ndarray,
    inset: float,
) -> Float[np.ndarray, "V 2"]:
    """Return where each edge meets the next; near a bend where they are nearly parallel."""
    cross = way[:, 0] * next_way[:, 1] - way[:, 1] * next_way[:, 0]
    apart = next_start - start
    along = apart[:, 0] * next_way[:, 1] - apart[:, 1] * next_way[:, 0]
    steep = np.abs(cross) > NEARLY_PARALLEL
    meeting = start + (along / np.where(steep, cross, 1.0))[:, None] * way
    onto = [
        from_ + ((bends - from_) * along_).sum(axis=1, keepdims=True) * along_
        for from_, along_ in ((start, way), (next_start, next_way))
    ]
    halfway = 0.5 * (onto[0] + onto[1])
    far = np.hypot(*(meeting - halfway).T) > FAR_CORNER + 2.0 * abs(inset)
    return np.where((steep & ~far)[:, None], meeting, halfway)
