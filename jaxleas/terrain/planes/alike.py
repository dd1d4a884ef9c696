"""Cells between planes that are nearly the same there: a larger square around each decides.

Where two planes meet in a shallow crease, they differ by less than the noise over a wide strip, and
a small square would deal out its cells by chance.
"""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Int

from jaxleas.terrain.planes.joining import neighbours
from jaxleas.terrain.planes.plane import Box, around
from jaxleas.terrain.planes.region import Growth, Region

ALIKE = 1.0
"""Difference of two planes below which the larger square decides, in standard deviations."""

SHARE = 0.2
"""Standard deviation of the weights in the larger square, as a share of its side."""


def settle_alike(
    ground: Growth, regions: Sequence[Region], owner: Int[np.ndarray, "R C"], size: int
) -> None:
    """Give the cells between neighbours that are alike to one of them, in place.

    Args:
        ground: heights and noise.
        regions: regions with the numbers 1, 2 and so on.
        owner: number of the region of each cell; 0 for none.
        size: number of cells along the side of the square that decides.
    """
    for one, other in neighbours(owner).tolist():
        box = _common(regions[one - 1].box, regions[other - 1].box, size, owner.shape)
        if box is not None:
            _settle_pair(ground, regions, owner[box], (one, other), box, size)


def _settle_pair(
    ground: Growth,
    regions: Sequence[Region],
    owner: Int[np.ndarray, "r c"],
    pair: tuple[int, int],
    box: Box,
    size: int,
) -> None:
    from scipy.ndimage import gaussian_filter, maximum_filter

    first, second = (regions[number - 1].plane.over(box) for number in pair)
    alike = np.abs(first - second) < ALIKE * ground.noise
    mine, theirs = (owner == number for number in pair)
    between = alike & (mine | theirs)
    for cells in (mine, theirs):
        between &= maximum_filter(cells, size=size)
    if not between.any():
        return
    middle = 0.5 * (first + second)
    # (z - a)^2 - (z - b)^2 = 2 (b - a) (z - (a + b) / 2)
    lead = (second - first) * (ground.heights[box] - middle)
    lead = np.where(alike & (mine | theirs), lead, 0.0)
    lead = gaussian_filter(lead, SHARE * size, mode="constant", truncate=2.5)
    owner[between] = np.where(lead[between] < 0.0, *pair)


def _common(one: Box, other: Box, reach: int, shape: tuple[int, int]) -> Box | None:
    """Return the part of a map within reach of two boxes; None if there is none."""
    sides = []
    for mine, theirs in zip(around(one, reach, shape), around(other, reach, shape), strict=True):
        low, high = max(mine.start, theirs.start), min(mine.stop, theirs.stop)
        if low >= high:
            return None
        sides.append(slice(low, high))
    return sides[0], sides[1]
