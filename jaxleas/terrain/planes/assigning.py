"""Each cell to the plane that fits the heights around it best, right up to the edges."""

from collections.abc import Callable, Sequence

import numpy as np
from jaxtyping import Bool, Float, Int

from jaxleas.terrain.planes.plane import Plane, around
from jaxleas.terrain.planes.region import Growth, Region

OUTLIER = 3.0
"""Standard deviations from which on a cell's distance from a plane counts no more."""
STRAY = OUTLIER + 1.0
"""Standard deviations beyond which a cell is off its own plane."""
LOYAL = 0.5
"""Squared distance, in standard deviations, by which another plane must fit the surroundings of a
cell better than the one that it has grown to: less is noise."""
NO_PLANE = 6.0
"""Squared distance, in standard deviations, above which the cells of 3 x 3 are on no plane: 1 where
noise alone is at work, 9 where all are outliers, and about 4 at an edge."""
KERNEL = np.array([0.25, 0.5, 0.25])
"""Weights of a cell and its neighbours along an axis, for that."""

Cells = tuple[np.ndarray, ...]
Smoothing = Callable[[np.ndarray], np.ndarray]


def assign(ground: Growth, regions: Sequence[Region], smooth: int) -> Int[np.ndarray, "R C"]:
    """Return the number of the region that each cell belongs to, from 1; 0 for none.

    Args:
        ground: heights, known cells and noise.
        regions: cores of planes.
        smooth: number of cells along the side of the square around a cell that decides; no cell is
            farther from a core than that.
    """
    from scipy.ndimage import maximum_filter

    best = np.full(ground.known.shape, np.inf)
    owner = np.zeros(ground.known.shape, np.int32)
    off = np.zeros_like(ground.known)
    even = _even(smooth)
    reach = smooth // 2 + 2
    for number, region in enumerate(regions, start=1):
        box = around(region.box, reach + smooth // 2, ground.known.shape)
        core = region.within(box)
        near = maximum_filter(core, size=2 * reach + 1)
        known = ground.known[box]
        square = ((ground.heights[box] - region.plane.over(box)) / ground.noise) ** 2
        stray = square > STRAY**2
        square = np.minimum(square, OUTLIER**2)
        misfit = _around_each(square, known, even) + np.where(core, 0.0, LOYAL)
        better = near & known & (misfit < best[box])
        better &= _around_each(square, known, _close) < NO_PLANE
        best[box][better] = misfit[better]
        owner[box][better] = number
        off[box][better] = stray[better]
    cells = np.nonzero(off)
    for _ in range(smooth // 2):
        cells = _settle_outliers(ground, [region.plane for region in regions], owner, cells)
    return owner


def _around_each(
    values: Float[np.ndarray, "r c"], known: Bool[np.ndarray, "r c"], smoothed: Smoothing
) -> Float[np.ndarray, "r c"]:
    """Return weighted means over the known cells around each cell."""
    if known.all():
        return smoothed(values)
    weight = known.astype(np.float64)
    return smoothed(values * weight) / np.maximum(smoothed(weight), 1e-9)


def _even(size: int) -> Smoothing:
    """Return what takes means over squares."""
    from scipy.ndimage import uniform_filter

    return lambda values: uniform_filter(values, size)


def _close(values: Float[np.ndarray, "r c"]) -> Float[np.ndarray, "r c"]:
    """Return means over 3 x 3 cells, the middle weighing most."""
    from scipy.ndimage import correlate1d

    return correlate1d(correlate1d(values, KERNEL, axis=0), KERNEL, axis=1)


def _settle_outliers(
    ground: Growth, planes: Sequence[Plane], owner: Int[np.ndarray, "R C"], cells: Cells
) -> Cells:
    """Give cells that are off their own plane to the best plane next to them, if one fits.

    Returns:
        Rows and columns of those cells: next time, no others can be off.
    """
    known = np.array([(np.nan, np.nan, np.nan), *planes])  # 0 is no plane
    row, column = cells

    def distance(numbers: np.ndarray) -> np.ndarray:
        plane = Plane(*known[numbers].T)  # pyright: ignore[reportArgumentType]
        return np.abs(ground.heights[row, column] - plane.at(row, column)) / ground.noise

    off = distance(owner[row, column]) > STRAY  # a NaN is not
    row, column = row[off], column[off]
    around_them = np.pad(owner, 1)
    nearest, chosen = np.full(len(row), OUTLIER), np.zeros(len(row), np.int32)
    for down in (0, 1, 2):
        for right in (0, 1, 2):
            number = around_them[row + down, column + right]
            gap = distance(number)
            closer = gap < nearest  # a NaN is not
            nearest[closer], chosen[closer] = gap[closer], number[closer]
    owner[row, column] = chosen
    return row, column
