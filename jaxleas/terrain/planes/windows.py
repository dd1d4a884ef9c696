"""Windowed normals: the plane that fits the heights around each cell best."""

import math
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
        return math.sqrt(12.0 / (self.size**2 * (self.size**2 - 1)))

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
    step = np.arange(size, dtype=np.float64) - size // 2
    ones = np.ones(size)
    n, (r, c), (rr, cc, rc) = _places(known, step)
    (z, rz), (cz,) = (_means(heights, (ones, step), ones), _means(heights, (ones,), step))
    (zz,) = _means(heights**2, (ones,), ones)
    count = np.rint(size**2 * n)
    usable = count >= max(6.0, LEAST_KNOWN * size**2)
    n = np.maximum(n, 1.0 / size**2)
    z, rz, cz, zz = z / n, rz / n, cz / n, zz / n
    rz, cz, zz = rz - r * z, cz - c * z, zz - z * z
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
        deviation=np.sqrt(rest * (count / np.maximum(count - 3.0, 1.0))),
    )


def _places(
    known: Bool[np.ndarray, "R C"], step: Float[np.ndarray, " S"]
) -> tuple[np.ndarray, Sequence[np.ndarray], Sequence[np.ndarray]]:
    """Return where the known cells of each window lie about its middle.

    Returns:
        Their share of the window; the means of their rows and columns; the variances of both and
        the covariance. Shapes that broadcast to that of the map.
    """
    powers = [step**power for power in range(3)]
    if known.all():  # rows and columns on their own
        rows, columns = (
            [_mean(np.ones(count), each, 0) for each in powers] for count in known.shape
        )
        n = rows[0][:, None] * columns[0]
        r, rr = (each[:, None] / rows[0][:, None] for each in rows[1:])
        c, cc = (each / columns[0] for each in columns[1:])
        rc = r * c
    else:
        weight = known.astype(np.float64)
        n, r, rr = _means(weight, powers, powers[0])
        c, rc = _means(weight, powers[:2], step)
        (cc,) = _means(weight, powers[:1], powers[2])
        some = np.maximum(n, 1.0 / len(step) ** 2)
        r, c, rr, cc, rc = (each / some for each in (r, c, rr, cc, rc))
    return n, (r, c), (rr - r * r, cc - c * c, rc - r * c)


def _means(
    values: Float[np.ndarray, "R C"], over_rows: Sequence[np.ndarray], over_columns: np.ndarray
) -> list[Float[np.ndarray, "R C"]]:
    """Return weighted means over the window of each cell, one for each of the weights over rows.

    What lies beyond the map is zero.
    """
    partial = _mean(values, over_columns, axis=1)
    return [_mean(partial, weights, axis=0) for weights in over_rows]


def _mean(values: np.ndarray, weights: Float[np.ndarray, " S"], axis: int) -> np.ndarray:
    from scipy.ndimage import correlate1d, uniform_filter1d

    if (weights == 1.0).all():
        return uniform_filter1d(values, len(weights), axis=axis, mode="constant")
    return correlate1d(values, weights / len(weights), axis=axis, mode="constant")
