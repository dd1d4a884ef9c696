"""Rises of a map that are too high for any step, as upright faces that block the trunk."""

from collections.abc import Iterator

import numpy as np
from jaxtyping import Float

from jaxleas.terrain.height_map import HeightMap
from jaxleas.terrain.scene import Polygons
from jaxleas.types import is_ground

LEAST = 0.5
"""Height of a rise between neighbouring cells from which on it is an obstacle [m]: more than a
robot of a human's size steps up, and less than its trunk is high above ground."""
EVEN = 0.1
"""Difference of the heights along a face, from which on it is parted [m]."""


def rises(height_map: HeightMap) -> Polygons:
    """Return an upright face for each row of cell sides at which the ground rises by half a metre.

    A face looks to the low side. It lies between the middles of the cells, so that it is up to half
    a cell from the wall. Where a cell has no height there is no face.

    Args:
        height_map: height map.
    """
    heights = np.where(is_ground(height_map.heights), height_map.heights, np.nan).astype(np.float64)
    x, y = height_map.origin
    faces = [*_across(heights, (x, y), height_map.resolution)]
    turned = _across(heights.T, (y, x), height_map.resolution)
    faces += [face[::-1, [1, 0, 2]] for face in turned]  # a mirror image is wound the other way
    return {f"rise_{number}": face for number, face in enumerate(faces)}


def _across(
    heights: Float[np.ndarray, "R C"], origin: tuple[float, float], cell: float
) -> Iterator[Float[np.ndarray, "4 3"]]:
    """Yield the faces between neighbours along rows, in runs along columns."""
    for column in np.flatnonzero((np.abs(np.diff(heights, axis=1)) >= LEAST).any(axis=0)).tolist():
        pairs = heights[:, column : column + 2]
        for rows in _runs(pairs):
            yield _face(pairs[rows], (column, rows.start), origin, cell)


def _runs(pairs: Float[np.ndarray, "R 2"]) -> Iterator[slice]:
    """Yield rows next to each other whose cells rise the same way, from and to about one height."""
    step = pairs[:, 1] - pairs[:, 0]  # a NaN is no rise
    run = slice(0, 0)
    for row in np.flatnonzero(np.abs(step) >= LEAST).tolist():
        longer = slice(run.start, row + 1)
        same = row == run.stop > run.start and step[row] * step[run.start] > 0.0
        if same and (np.ptp(pairs[longer], axis=0) <= EVEN).all():
            run = longer
            continue
        if run.stop > run.start:
            yield run
        run = slice(row, row + 1)
    if run.stop > run.start:
        yield run


def _face(
    pairs: Float[np.ndarray, "N 2"],
    first: tuple[int, int],
    origin: tuple[float, float],
    cell: float,
) -> Float[np.ndarray, "4 3"]:
    x = origin[0] + (first[0] + 0.5) * cell
    near, far = origin[1] + (first[1] + np.array([-0.5, len(pairs) - 0.5])) * cell
    low, high = pairs.min(), pairs.max()
    face = np.array([[x, near, low], [x, far, low], [x, far, high], [x, near, high]])
    return face if pairs[0, 1] < pairs[0, 0] else face[::-1]
