"""A plane over the cells of a map, and the one that fits heights best."""

from functools import lru_cache
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
        rows, columns = (np.arange(side.start, side.stop) for side in box)
        return (self.height + self.along_rows * rows)[:, None] + self.along_columns * columns

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


def inner(box: Box, part: Box) -> Box:
    """Return a part of a box as a part of the map."""
    rows, columns = (
        slice(side.start + int(own.start), side.start + int(own.stop))
        for side, own in zip(box, part, strict=True)
    )
    return rows, columns


def fitted(heights: Float[np.ndarray, "R C"], cells: Bool[np.ndarray, "R C"], box: Box) -> Plane:
    """Return the plane with the least squared vertical distances from cells.

    Args:
        heights: heights of a part of the map, none of them NaN [m].
        cells: cells that count; at least three, not all on one line.
        box: part of the map that it is.
    """
    weight = cells.astype(np.float64)
    powers = [_powers(count) for count in cells.shape]
    (n, c, cc), (r, rc, _), (rr, _, _) = _moments(weight, *powers)
    (z, cz, _), (rz, _, _), _ = _moments(weight * heights, *powers)
    r, c, z = r / n, c / n, z / n
    rr, cc, rc = rr - n * r * r, cc - n * c * c, rc - n * r * c
    rz, cz = rz - n * r * z, cz - n * c * z
    determinant = rr * cc - rc * rc
    if determinant <= 1e-9 * max(rr * cc, 1.0):  # a line of cells has no slope across it
        along_rows, along_columns = rz / max(rr, 1.0), cz / max(cc, 1.0)
    else:
        along_rows = (cc * rz - rc * cz) / determinant
        along_columns = (rr * cz - rc * rz) / determinant
    row, column = box[0].start + cells.shape[0] // 2 + r, box[1].start + cells.shape[1] // 2 + c
    return Plane(z - along_rows * row - along_columns * column, along_rows, along_columns)


@lru_cache(maxsize=1000)
def _powers(count: int) -> Float[np.ndarray, "3 N"]:
    """Return the powers 0 to 2 of numbers about their middle."""
    number = np.arange(count) - count // 2.0
    return np.stack([np.ones(count), number, number * number])


def _moments(
    weight: Float[np.ndarray, "r c"], rows: Float[np.ndarray, "3 r"], columns: np.ndarray
) -> list[list[float]]:
    """Return the sums of weights times powers of their row (first index) and column."""
    per_row = np.einsum("rc,pc->rp", weight, columns)  # large matrices, and no threads for them
    return (rows @ per_row).tolist()
