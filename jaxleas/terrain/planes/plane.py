"""A plane over the cells of a map, and the one that fits heights best."""

from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float

Box = tuple[slice, slice]
"""Rows and columns of a part of a map."""


class Plane(NamedTuple):
    """Heights that change evenly from cell to cell.

    Attributes:
        height: height at cell (0, 0) [m].
        along_rows: change of height from a row to the next [m].
        along_columns: change of height from a column to the next [m].
    """

    height: float
    along_rows: float
    along_columns: float

    def over(self, box: Box) -> Float[np.ndarray, "R C"]:
        """Return the plane's heights over a part of the map [m]."""
        rows = np.arange(box[0].start, box[0].stop)[:, None]
        columns = np.arange(box[1].start, box[1].stop)
        return self.height + self.along_rows * rows + self.along_columns * columns

    def at(self, row: np.ndarray, column: np.ndarray) -> np.ndarray:
        """Return the plane's heights at places in cells [m]."""
        return self.height + self.along_rows * row + self.along_columns * column


def around(box: Box, reach: int, shape: tuple[int, int]) -> Box:
    """Return a part of a map with `reach` more cells on each side, as far as the map goes."""
    rows, columns = (
        slice(max(side.start - reach, 0), min(side.stop + reach, cells))
        for side, cells in zip(box, shape, strict=True)
    )
    return rows, columns


def fitted(heights: Float[np.ndarray, "R C"], cells: Bool[np.ndarray, "R C"], box: Box) -> Plane:
    """Return the plane with the least squared vertical distances from cells.

    Args:
        heights: heights of a part of the map, none of them NaN [m].
        cells: cells that count; at least three, not all on one line.
        box: part of the map that it is.
    """
    # Sums over rows and columns first: the moments of many cells are those of few sums.
    weight = cells.astype(np.float64)
    some = weight * heights
    per_row, per_column = weight.sum(axis=1), weight.sum(axis=0)
    row_heights, column_heights = some.sum(axis=1), some.sum(axis=0)
    count = per_row.sum()
    row, column = np.arange(len(per_row)), np.arange(len(per_column))
    middle = np.array([per_row @ row, per_column @ column, row_heights.sum()]) / count
    r, c = row - middle[0], column - middle[1]
    rr, cc = per_row @ r**2, per_column @ c**2
    rc = r @ np.einsum("rc,c->r", weight, c)
    rz, cz = r @ row_heights, c @ column_heights
    determinant = rr * cc - rc * rc
    if determinant <= 1e-9 * max(rr * cc, 1.0):  # a line of cells has no slope across it
        along_rows, along_columns = rz / max(rr, 1.0), cz / max(cc, 1.0)
    else:
        along_rows = (cc * rz - rc * cz) / determinant
        along_columns = (rr * cz - rc * rz) / determinant
    first = (box[0].start + middle[0], box[1].start + middle[1])
    height = middle[2] - along_rows * first[0] - along_columns * first[1]
    return Plane(float(height), float(along_rows), float(along_columns))
