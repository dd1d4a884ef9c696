"""Windowed normals: the plane that fits the heights around each cell best."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float

LEAST_KNOWN = 0.5
"""Part of a window's cells that must have a height."""


@dataclass(frozen=True)
class Windows:
    """Planes fitted in the square windows around all cells; NaN where too few have a height.

    Attributes:
        size: number of cells along the side of a window.
        height: height of the plane in the middle of the window [m].
        along_rows: change of height from a row to the next [m].
        along_columns: change of height from a column to the next [m].
        deviation: standard deviation of the cells about the plane [m].
    """

    size: int
    height: Float[np.ndarray, "R C"]
    along_rows: Float[np.ndarray, "R C"]
    along_columns: Float[np.ndarray, "R C"]
    deviation: Float[np.ndarray, "R C"]

    @property
    def slope_share(self) -> float:
        """Standard deviation of a slope per cell, as a multiple of that of the heights."""
        step = np.arange(self.size) - self.size // 2
        return float(1.0 / np.sqrt(self.size * (step**2).sum()))

    @property
    def freedom(self) -> int:
        """Number of cells of a whole window beyond the three that a plane needs."""
        return self.size**2 - 3


def fit_windows(
    heights: Float[np.ndarray, "R C"], known: Bool[np.ndarray, "R C"], size: int
) -> Windows:
    """Return the least squares planes of all windows, from sums over windows.

    Args:
        heights: heights [m]; zero where unknown.
        known: which cells have a height.
        size: number of cells along the side of a window, odd.
    """
    ones = np.ones(size)
    step = np.arange(size, dtype=np.float64) - size // 2
    weight = known.astype(np.float64)
    n, r, rr = _sums(weight, (ones, step, step**2), ones)
    c, rc = _sums(weight, (ones, step), step)
    (cc,) = _sums(weight, (ones,), step**2)
    z, rz = _sums(heights, (ones, step), ones)
    (cz,) = _sums(heights, (ones,), step)
    (zz,) = _sums(heights**2, (ones,), ones)
    usable = n >= max(6.0, LEAST_KNOWN * size * size)
    n = np.maximum(n, 1.0)
    r, c, z = r / n, c / n, z / n
    rr, cc, rc = rr / n - r * r, cc / n - c * c, rc / n - r * c
    rz, cz, zz = rz / n - r * z, cz / n - c * z, zz / n - z * z
    determinant = rr * cc - rc * rc
    usable &= determinant > 1e-6
    determinant = np.where(usable, determinant, np.nan)
    along_rows = (cc * rz - rc * cz) / determinant
    along_columns = (rr * cz - rc * rz) / determinant
    rest = np.maximum(zz - along_rows * rz - along_columns * cz, 0.0)
    return Windows(
        size=size,
        height=z - along_rows * r - along_columns * c,
        along_rows=along_rows,
        along_columns=along_columns,
        deviation=np.sqrt(rest * n / np.maximum(n - 3.0, 1.0)),
    )


def _sums(
    values: Float[np.ndarray, "R C"], over_rows: Sequence[np.ndarray], over_columns: np.ndarray
) -> list[Float[np.ndarray, "R C"]]:
    """Return sums over the window of each cell, one for each of the weights over rows.

    Nothing lies beyond the map.
    """
    from scipy.ndimage import correlate1d

    partial = correlate1d(values, over_columns, axis=1, mode="constant")
    return [correlate1d(partial, weights, axis=0, mode="constant") for weights in over_rows]
