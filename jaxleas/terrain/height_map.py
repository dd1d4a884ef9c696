"""Height maps: one height per cell, NaN where there is no ground."""

import logging
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from jaxtyping import Float, Float32

from jaxleas.files import read_npz, require_version_array, write_npz
from jaxleas.types import InputError, is_ground

MIN_RESOLUTION, MAX_RESOLUTION = 0.005, 0.5
"""Accepted cell sizes [m]: a foot needs no finer cells, and coarser ones miss bridges and steps."""
MAX_CELLS = 64_000_000
MAX_BYTES = 8 * MAX_CELLS + 2**20
VERSION = 1
NO_DATA = (-9999.0, -32767.0, -32768.0)
"""Numbers that surveys write where they know no height."""
_LOG = logging.getLogger("jaxleas")
TALL, STEEPEST = 20.0, 5.0
"""Heights that span more than this [m], and this many times the map's width, may be no metres."""
MAX_HEIGHT = 10_000.0
"""Height above which the units are probably wrong [m]."""


@dataclass(frozen=True)
class HeightMap:
    """A terrain as a grid of heights.

    Attributes:
        heights: heights [row = y, column = x] [m]; NaN where there is no ground.
        resolution: edge of a cell [m].
        origin: x, y of the centre of cell (0, 0) [m].
    """

    heights: Float32[np.ndarray, "rows columns"]
    resolution: float
    origin: tuple[float, float]

    @property
    def shape(self) -> tuple[int, int]:
        """Rows and columns."""
        return self.heights.shape[0], self.heights.shape[1]

    @property
    def extent(self) -> tuple[float, float, float, float]:
        """Outer edges of the outermost cells: x_min, x_max, y_min, y_max [m]."""
        rows, columns = self.shape
        x_min, y_min = (value - 0.5 * self.resolution for value in self.origin)
        return x_min, x_min + columns * self.resolution, y_min, y_min + rows * self.resolution

    @property
    def void_fraction(self) -> float:
        """Fraction of cells without ground."""
        return float(1.0 - is_ground(self.heights).mean())

    def height_at(self, points: Float[np.ndarray, "N 2"]) -> Float32[np.ndarray, " N"]:
        """Return the height of the cell around each point (x, y) [m]; NaN outside the map."""
        points = np.asarray(points, dtype=np.float64).reshape(-1, 2)
        rows, columns = self.shape
        cells = np.floor((points - np.array(self.origin)) / self.resolution + 0.5)
        inside = np.all((cells >= 0) & (cells < np.array([columns, rows])), axis=1)
        column, row = np.where(inside[:, None], cells, 0.0).astype(np.int64).T
        return np.where(inside, self.heights[row, column], np.float32(np.nan))


def read_height_map(path: str | Path) -> HeightMap:
    """Read a height map from .npz: `heights`, `resolution` [m], `origin` x, y [m], any numbers.

    `height` stands for `heights` too, and without an origin cell (0, 0) lies at x = y = 0, which is
    said.

    Raises:
        InputError: an array is missing or unusable; the message says which, and what would do.
    """
    arrays = read_npz(path, required=("resolution",), max_bytes=MAX_BYTES)
    require_version_array(arrays, VERSION, path)
    heights, resolution = _heights_in(path, arrays), arrays["resolution"]
    if "origin" not in arrays:
        _LOG.warning("%s states no origin: its cell (0, 0) lies at x = y = 0", path)
    origin = arrays.get("origin", np.zeros(2))
    if heights.dtype.kind not in "fiu":
        raise InputError(f"{path}: heights are {heights.dtype}; they must be numbers [m]")
    if heights.ndim != 2 or min(heights.shape) < 2:
        raise InputError(
            f"{path}: heights have shape {heights.shape}; at least 2 x 2, [rows = y, columns = x]"
        )
    if resolution.size != 1 or resolution.dtype.kind not in "fiu":
        raise InputError(f"{path}: resolution must be one number [m]")
    if origin.shape != (2,) or origin.dtype.kind not in "fiu" or not np.isfinite(origin).all():
        raise InputError(f"{path}: origin must be two finite numbers, x and y of cell (0, 0) [m]")
    require_usable(heights, float(resolution.reshape(())), path)  # also beyond float32
    return HeightMap(
        np.ascontiguousarray(heights, dtype=np.float32),
        float(resolution.reshape(())),
        (float(origin[0]), float(origin[1])),
    )


def _heights_in(path: str | Path, arrays: dict[str, np.ndarray]) -> np.ndarray:
    for name in ("heights", "height"):
        if name in arrays:
            return arrays[name]
    raise InputError(
        f"{path} lacks the array heights; it holds {', '.join(map(ascii, arrays))[:200]}"
    )


def say_if_tall(height_map: HeightMap, where: str | Path) -> None:
    """Say so if a map is much higher than wide: its heights may not be metres."""
    x_min, x_max, y_min, y_max = height_map.extent
    width = max(x_max - x_min, y_max - y_min)
    span = float(np.nanmax(height_map.heights) - np.nanmin(height_map.heights))
    if span > max(TALL, STEEPEST * width):
        _LOG.warning(
            "%s: its heights span %.4g m on a map %.4g m wide: are they metres? If the option"
            " applies, --scale says how many metres a unit is",
            *(where, span, width),
        )


def write_height_map(path: str | Path, height_map: HeightMap) -> None:
    """Write a height map as .npz, whole or not at all."""
    write_npz(
        path,
        heights=height_map.heights.astype(np.float32),
        resolution=np.array(height_map.resolution, dtype=np.float64),
        origin=np.array(height_map.origin, dtype=np.float64),
        version=np.array(VERSION),
    )


def require_usable(
    heights: Float[np.ndarray, "rows columns"], resolution: float, where: str | Path
) -> None:
    """Refuse heights without ground, with infinities or kilometres, and absurd cell sizes."""
    require_resolution(resolution, where)
    if heights.size > MAX_CELLS:
        raise InputError(f"{where}: {heights.size} cells, more than the {MAX_CELLS} accepted")
    if np.isinf(heights).any():
        raise InputError(f"{where}: heights hold infinity; use NaN where there is no ground")
    if np.isnan(heights).all():
        raise InputError(f"{where}: every height is NaN: there is no ground anywhere")
    highest = float(np.nanmax(np.abs(heights)))
    if highest > MAX_HEIGHT:
        raise InputError(f"{where}: a height of {highest:.6g} m is no terrain; are these metres?")


def without_no_data(
    path: str | Path, heights: Float[np.ndarray, "*cells"]
) -> Float[np.ndarray, "*cells"]:
    """Return heights with NaN for the numbers that stand for no data in surveys; it is said."""
    nothing = np.isin(heights, NO_DATA)
    if nothing.any():
        _LOG.warning(
            "%s: %d cells of %g mean no data: no ground there",
            *(path, nothing.sum(), heights[nothing][0]),
        )
    return np.where(nothing, np.nan, heights)


def require_resolution(resolution: float, where: str | Path) -> None:
    """Refuse a cell size outside [0.005, 0.5] m, or one that is not a number."""
    if not MIN_RESOLUTION <= resolution <= MAX_RESOLUTION:
        raise InputError(
            f"{where}: resolution {resolution:g} m is outside "
            f"[{MIN_RESOLUTION:g}, {MAX_RESOLUTION:g}] m; 0.04 m is usual"
        )
