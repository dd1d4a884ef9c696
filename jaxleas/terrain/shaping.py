"""What is done with a terrain that was read: moved, cropped, its holes filled, smoothed."""

import logging
from dataclasses import replace
from pathlib import Path
from typing import cast

import numpy as np
from jaxtyping import Bool, Float, Int

from jaxleas.terrain.height_map import HeightMap
from jaxleas.terrain.places import AUTO, FARTHEST, require_near, shift_of
from jaxleas.terrain.reading import Reading, Rectangle
from jaxleas.types import InputError, is_ground

_LOG = logging.getLogger("jaxleas")
_SWEEPS = 200  # of averaging in filled holes; what is left of the first guess is below a millimetre


def moved(path: str | Path, height_map: HeightMap, origin: str | None) -> HeightMap:
    """Return a map whose `origin` became x = y = 0; maps beyond 10 km are refused."""
    x_min, x_max, y_min, y_max = height_map.extent
    shift = shift_of(path, origin, (x_min, y_min))
    require_near(path, np.array([[x_min, y_min], [x_max, y_max]]) - shift[:2])
    x, y = height_map.origin
    return replace(
        height_map,
        heights=height_map.heights - np.float32(shift[2]) if shift[2] else height_map.heights,
        origin=(float(x - shift[0]), float(y - shift[1])),
    )


def brought_near(path: str | Path, height_map: HeightMap, reading: Reading) -> HeightMap:
    """Return a survey's map moved as `auto` does, if it lies far away and no origin is given."""
    if reading.origin is None and max(np.abs(height_map.extent)) > FARTHEST:
        return moved(path, height_map, AUTO)
    return height_map


def shaped(path: str | Path, height_map: HeightMap, reading: Reading) -> HeightMap:
    """Return a map cropped, its holes filled, and smoothed, as `reading` says.

    Args:
        path: path of its file, for messages.
        height_map: map as it was read.
        reading: what is to be done.

    Raises:
        InputError: a value is impossible, or nothing would be left.
    """
    if reading.crop is not None:
        height_map = cropped(path, height_map, reading.crop)
    if reading.fill is not None:
        height_map = filled(path, height_map, _positive("fill", reading.fill))
    if reading.smooth is not None:
        height_map = smoothed(path, height_map, _positive("smooth", reading.smooth))
    return height_map


def cropped(path: str | Path, height_map: HeightMap, crop: Rectangle) -> HeightMap:
    """Return the cells of a map whose middles lie in a rectangle."""
    x_min, x_max, y_min, y_max = require_rectangle(crop)
    rows, columns = height_map.shape
    x = height_map.origin[0] + height_map.resolution * np.arange(columns)
    y = height_map.origin[1] + height_map.resolution * np.arange(rows)
    column = np.flatnonzero((x >= x_min) & (x <= x_max))
    row = np.flatnonzero((y >= y_min) & (y <= y_max))
    low, high, near, far = height_map.extent
    if len(column) < 2 or len(row) < 2:
        raise InputError(
            f"--crop leaves {len(column)} x {len(row)} cells of {path}, which spans x {low:.2f} to"
            f" {high:.2f} m, y {near:.2f} to {far:.2f} m; at least 2 x 2"
        )
    part = height_map.heights[row[0] : row[-1] + 1, column[0] : column[-1] + 1]
    if not is_ground(part).any():
        raise InputError(f"--crop leaves no ground of {path}: all of it is void")
    return HeightMap(
        np.ascontiguousarray(part), height_map.resolution, (float(x[column[0]]), float(y[row[0]]))
    )


def require_rectangle(crop: Rectangle) -> Rectangle:
    """Refuse a rectangle without area."""
    x_min, x_max, y_min, y_max = crop
    if not (np.isfinite(crop).all() and x_min < x_max and y_min < y_max):
        raise InputError(
            f"--crop {' '.join(f'{each:g}' for each in crop)}: it takes X_MIN X_MAX Y_MIN Y_MAX,"
            " the smaller one first"
        )
    return crop


def holes(
    heights: Float[np.ndarray, "R C"],
) -> tuple[Int[np.ndarray, "R C"], Bool[np.ndarray, " H"]]:
    """Return the number of the void region of each cell, 0 on ground, and which are holes.

    A hole is void with ground all around it; void that reaches the rim of the map is none.
    Entry 0 of the second array is False: it is the ground.
    """
    from scipy.ndimage import label

    region, count = cast(tuple[np.ndarray, int], label(~is_ground(heights)))
    inside = np.ones(count + 1, bool)
    rim = np.concatenate([region[0], region[-1], region[:, 0], region[:, -1]])
    inside[np.concatenate([rim, [0]])] = False
    return region, inside


def filled(path: str | Path, height_map: HeightMap, widest: float) -> HeightMap:
    """Return a map without holes up to a width: their heights are averaged from their rims."""
    from scipy.ndimage import distance_transform_edt, find_objects

    heights = height_map.heights
    region, inside = holes(heights)
    small = np.zeros(len(inside), bool)
    for number, box in enumerate(find_objects(region), start=1):
        cells = max(side.stop - side.start for side in box)
        small[number] = inside[number] and cells * height_map.resolution <= widest + 1e-9
    hole = small[region]
    if not hole.any():
        left = int(inside.sum())
        _LOG.warning("%s: no hole is up to %g m wide; %d wider ones stay", path, widest, left)
        return height_map
    nearest = distance_transform_edt(
        ~is_ground(heights), return_distances=False, return_indices=True
    )
    assert nearest is not None
    full = heights[tuple(nearest)].astype(np.float64)
    row, column = np.nonzero(hole)  # never at the rim
    for _ in range(_SWEEPS):
        around = full[row - 1, column] + full[row + 1, column]
        full[row, column] = 0.25 * (around + full[row, column - 1] + full[row, column + 1])
    _LOG.warning(
        "%s: %d holes, %.2f m2 in all, are filled from their rims; %d wider ones stay",
        *(path, small.sum(), hole.sum() * height_map.resolution**2, (inside & ~small).sum()),
    )
    return replace(height_map, heights=np.where(hole, full.astype(np.float32), heights))


def smoothed(path: str | Path, height_map: HeightMap, deviation: float) -> HeightMap:
    """Return a map averaged with a Gaussian; void stays void and does not count."""
    from scipy.ndimage import gaussian_filter

    ground = is_ground(height_map.heights)
    cells = deviation / height_map.resolution
    weight = gaussian_filter(ground.astype(np.float64), cells, mode="constant", truncate=3.0)
    sums = gaussian_filter(
        np.where(ground, height_map.heights, 0.0).astype(np.float64),
        *(cells,),
        mode="constant",
        truncate=3.0,
    )
    heights = np.where(ground, sums / np.where(ground, weight, 1.0), np.nan).astype(np.float32)
    change = float(np.nanmax(np.abs(heights - np.where(ground, height_map.heights, np.nan))))
    _LOG.warning("%s: smoothing changes heights by up to %.3f m", path, change)
    return replace(height_map, heights=heights)


def _positive(name: str, value: float) -> float:
    if not 0.0 < value <= 10.0:
        raise InputError(f"--{name} {value:g} must be a length up to 10 m")
    return value
