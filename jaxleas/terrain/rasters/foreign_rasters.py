"""TIFF images and GridMaps of bags as height maps."""

import logging
from pathlib import Path

import numpy as np

from jaxleas.terrain.foreign.asking import ask
from jaxleas.terrain.height_map import (
    MAX_CELLS,
    MAX_RESOLUTION,
    MIN_RESOLUTION,
    HeightMap,
    require_resolution,
    require_usable,
    without_no_data,
)
from jaxleas.terrain.rasters.images import say_step
from jaxleas.terrain.reading import Reading
from jaxleas.terrain.shaping import brought_near
from jaxleas.types import InputError, is_ground

_LOG = logging.getLogger("jaxleas")


def read_tiff(path: Path, reading: Reading) -> HeightMap:
    """Return the height map of a TIFF: heights times `scale`, or grey levels from z_min to z_max.

    A GeoTIFF states its cells; one that lies far away is moved as `--origin auto` does.
    """
    arrays = ask("tiff", path)
    values = without_no_data(path, arrays["heights"]) * reading.scale
    if reading.zero_is_void:
        values = np.where(values == 0.0, np.nan, values)
    if (reading.z_min is None) != (reading.z_max is None):
        raise InputError(f"{path}: z_min and z_max go together: the heights of black and white")
    if reading.z_min is not None and reading.z_max is not None:
        values = _grey(path, values, arrays, (reading.z_min, reading.z_max))
    elif arrays["whole"]:
        _LOG.warning(
            "%s holds whole numbers: each step is %g m of height; --scale, or --z-min and --z-max,"
            " say otherwise",
            *(path, reading.scale),
        )
    cell, corner = arrays.get("cell"), arrays.get("corner")
    if cell is None or corner is None:
        if reading.resolution is None:
            raise InputError(f"{path} states no place: say its resolution, the edge of a pixel [m]")
        half = 0.5 * reading.resolution
        return _usable(path, values, reading.resolution, (half, half))
    x, y = (float(each) for each in corner)
    found = HeightMap(values.astype(np.float32), float(cell), (x, y))
    return with_cells(path, brought_near(path, found, reading), reading)


def _grey(
    path: Path, values: np.ndarray, arrays: dict[str, np.ndarray], span: tuple[float, float]
) -> np.ndarray:
    if not arrays["whole"]:
        raise InputError(f"{path} holds heights, no grey levels: z_min and z_max do not apply")
    if not (np.isfinite(span).all() and span[0] < span[1]):
        raise InputError(f"{path}: z_min {span[0]:g} m must be below z_max {span[1]:g} m")
    white = float(arrays["levels"]) - 1.0
    say_step(path, int(arrays["levels"]), span[1] - span[0])
    return span[0] + (span[1] - span[0]) * values / white


def read_grid_map(path: Path, reading: Reading) -> HeightMap:
    """Return the height map of a GridMap in a bag of ROS 1 or 2, or in an MCAP file."""
    arrays = ask("grid_map", path, topic=reading.topic, layer=reading.layer)
    x, y = (float(each) for each in arrays["origin"])
    heights = arrays["heights"].astype(np.float32)
    heights[np.isinf(heights)] = np.nan
    return with_cells(path, HeightMap(heights, float(arrays["resolution"]), (x, y)), reading)


def with_cells(path: Path, found: HeightMap, reading: Reading) -> HeightMap:
    """Return a map whose cells are usable; other ones are resampled, which is said.

    Raises:
        InputError: usable cells contradict `reading.resolution`, or there would be too many.
    """
    cell, wanted = found.resolution, reading.resolution
    if min(found.shape) < 2 or not (np.isfinite(cell) and cell > 0.0):
        raise InputError(f"{path} has {found.shape[1]} x {found.shape[0]} cells of {cell:g} m")
    usable = MIN_RESOLUTION <= cell <= MAX_RESOLUTION
    if usable and wanted is not None and not np.isclose(wanted, cell):
        raise InputError(
            f"{path} is a map of {cell:g} m cells;"
            f" it cannot be read at a resolution of {wanted:g} m"
        )
    if not usable:
        wanted = wanted or (MAX_RESOLUTION if cell > MAX_RESOLUTION else MIN_RESOLUTION)
        require_resolution(wanted, path)
        if reading.crop is not None:
            found = _part(found, reading)
        found = _resampled(path, found, wanted)
        _LOG.warning(
            "%s: its cells of %g m are resampled to %g m, linearly between their middles",
            *(path, cell, wanted),
        )
    return _usable(path, found.heights, found.resolution, found.origin)


def _part(found: HeightMap, reading: Reading) -> HeightMap:
    """Return the cells around what is kept, before there are many more of them."""
    assert reading.crop is not None
    if reading.origin is not None:
        return found  # kept is what lies there after it was moved
    x_min, x_max, y_min, y_max = reading.crop
    at = (np.array([[x_min, y_min], [x_max, y_max]]) - found.origin) / found.resolution
    limits = np.array(found.shape[::-1])
    low = np.clip(np.floor(at[0]).astype(int) - 1, 0, limits - 2)
    high = np.clip(np.ceil(at[1]).astype(int) + 2, low + 2, limits)
    origin = np.array(found.origin) + low * found.resolution
    return HeightMap(
        found.heights[low[1] : high[1], low[0] : high[0]],
        found.resolution,
        (float(origin[0]), float(origin[1])),
    )


def _resampled(path: Path, found: HeightMap, cell: float) -> HeightMap:
    from scipy.ndimage import map_coordinates

    size = np.array(found.shape) - 1
    count = np.floor(size * found.resolution / cell + 1e-9).astype(int) + 1
    if float(count[0]) * float(count[1]) > MAX_CELLS:
        raise InputError(
            f"{path} makes {count[1]} x {count[0]} cells of {cell:g} m, more than {MAX_CELLS}: give"
            " --crop, or a coarser --resolution"
        )
    step = cell / found.resolution
    rows, columns = (step * np.arange(each) for each in count)
    at = np.meshgrid(np.minimum(rows, size[0]), np.minimum(columns, size[1]), indexing="ij")
    ground = is_ground(found.heights)
    known, heights = (
        map_coordinates(each, at, order=1, mode="nearest", prefilter=False)
        for each in (ground.astype(np.float32), np.where(ground, found.heights, 0.0))
    )
    # A cell without ground that has no weight in a place says nothing of it.
    heights = np.where(known > 1.0 - 1e-6, heights, np.nan)
    return HeightMap(heights.astype(np.float32), cell, found.origin)


def _usable(
    path: Path, values: np.ndarray, resolution: float, origin: tuple[float, float]
) -> HeightMap:
    heights = np.ascontiguousarray(values, dtype=np.float32)
    if heights.ndim != 2 or min(heights.shape) < 2:
        raise InputError(f"{path} has the shape {heights.shape}; a map is at least 2 x 2 cells")
    require_usable(heights, resolution, path)
    return HeightMap(heights, float(resolution), origin)
