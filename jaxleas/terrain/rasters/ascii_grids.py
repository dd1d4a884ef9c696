"""ESRI ASCII grids (.asc) as height maps: a header of keys, then rows from the north."""

import re
import warnings
from pathlib import Path

import numpy as np
from jaxtyping import Float

from jaxleas.files import read_bytes
from jaxleas.terrain.height_map import MAX_CELLS, HeightMap, without_no_data
from jaxleas.terrain.rasters.foreign_rasters import with_cells
from jaxleas.terrain.reading import Reading
from jaxleas.terrain.shaping import brought_near
from jaxleas.terrain.text_numbers import shown, without_mark
from jaxleas.types import InputError

MAX_TEXT = 2**28
USUAL_NO_DATA = -9999.0
FINEST = 1e-3
"""Edge of a cell below which the unit must be the degree [m]."""
_PLACES = ("xllcorner", "xllcenter", "yllcorner", "yllcenter")
_KEYS = ("ncols", "nrows", "cellsize", "nodata_value", "dx", "dy", *_PLACES)
_ENTRY = re.compile(rb"\s*([A-Za-z_]+)\s+(\S+)")


def read_asc(path: Path, reading: Reading) -> HeightMap:
    """Return the height map of an ESRI ASCII grid, which states its place, cells and no data.

    One that lies far away is moved as `--origin auto` does.
    """
    content = without_mark(read_bytes(path, MAX_TEXT))
    keys, body = _header(path, content)
    columns, rows = (_count(path, keys, name) for name in ("ncols", "nrows"))
    if columns * rows > MAX_CELLS:
        raise InputError(f"{path} has {columns} x {rows} cells, more than {MAX_CELLS}")
    cell = _cell(path, keys)
    values = _numbers(path, body)
    if values.size != rows * columns:
        raise InputError(
            f"{path} has {values.size} heights, where {rows} rows of {columns} need"
            f" {rows * columns}"
        )
    heights = values.reshape(rows, columns)[::-1]
    heights = np.where(heights == keys.get("nodata_value", USUAL_NO_DATA), np.nan, heights)
    heights = without_no_data(path, heights) * reading.scale
    corner = tuple(_low(path, keys, axis, cell) for axis in "xy")
    found = HeightMap(heights.astype(np.float32), cell, (corner[0], corner[1]))
    return with_cells(path, brought_near(path, found, reading), reading)


def _header(path: Path, content: bytes) -> tuple[dict[str, float], bytes]:
    """Return the numbers of the header by their keys in small letters, and the text after it."""
    keys: dict[str, float] = {}
    at = 0
    while found := _ENTRY.match(content, at):
        name = found[1].decode().lower()
        if name not in _KEYS:
            break
        try:
            keys[name] = float(found[2].replace(b",", b"."))
        except ValueError as error:
            raise InputError(f"{path}: {name} is {shown(found[2])}, no number") from error
        at = found.end()
    if "ncols" not in keys or "nrows" not in keys:
        raise InputError(f"{path} is no ESRI ASCII grid: it does not begin with ncols and nrows")
    return keys, content[at:]


def _numbers(path: Path, text: bytes) -> Float[np.ndarray, " N"]:
    with warnings.catch_warnings():
        warnings.simplefilter("error", DeprecationWarning)  # where it ends before the text does
        try:
            return np.fromstring(text.replace(b",", b"."), np.float64, sep=" ")
        except (DeprecationWarning, ValueError) as error:
            raise InputError(f"{path} holds something that is no number among its rows") from error


def _count(path: Path, keys: dict[str, float], name: str) -> int:
    number = keys[name]
    if not (number == np.trunc(number) and 2 <= number <= MAX_CELLS):
        raise InputError(f"{path}: {name} is {number:g}; a map is at least 2 x 2 cells")
    return int(number)


def _cell(path: Path, keys: dict[str, float]) -> float:
    sides = [keys.get("cellsize", keys.get(name, np.nan)) for name in ("dx", "dy")]
    if not (np.isfinite(sides).all() and sides[0] > 0.0):
        raise InputError(f"{path} states no cellsize, the edge of a cell [m]")
    if abs(sides[0] - sides[1]) > 1e-3 * sides[0]:
        raise InputError(f"{path} has cells of {sides[0]:g} x {sides[1]:g}; a map has square ones")
    if sides[0] < FINEST:
        raise InputError(
            f"{path} has cells of {sides[0]:g}, which must be degrees; warp it to metres first,"
            " such as UTM"
        )
    return sides[0]


def _low(path: Path, keys: dict[str, float], axis: str, cell: float) -> float:
    """Return x or y of the middle of the south-west cell [m]; 0 at its corner where not stated."""
    corner, middle = keys.get(f"{axis}llcorner"), keys.get(f"{axis}llcenter")
    low = middle if middle is not None else (corner or 0.0) + 0.5 * cell
    if not np.isfinite(low):
        raise InputError(f"{path}: {axis}llcorner is no finite number")
    return low
