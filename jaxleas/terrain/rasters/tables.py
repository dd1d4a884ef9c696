"""Tables of heights: .npy arrays, and text with commas, semicolons, tabs or spaces."""

import codecs
import csv
import io
from pathlib import Path

import numpy as np
from jaxtyping import Float

from jaxleas.files import read_array, read_bytes
from jaxleas.terrain.height_map import (
    MAX_BYTES,
    MAX_CELLS,
    HeightMap,
    require_usable,
    without_no_data,
)
from jaxleas.terrain.reading import Reading
from jaxleas.terrain.text_numbers import without_mark
from jaxleas.types import InputError

MAX_TEXT = 2**28
_NOTHING = ("", "nan", "na", "n/a", "null", "none", "-")
_FEWEST_POINTS = 20  # rows of three numbers, from which on they may be points rather than a map


def read_npy(path: Path, reading: Reading) -> HeightMap:
    """Return the height map of a .npy array [rows = y, columns = x], of any number type."""
    return _map(path, read_array(path, MAX_BYTES), reading)


def read_csv(path: Path, reading: Reading) -> HeightMap:
    """Return the height map of a text table: a grid of heights, or points under `x,y,z`.

    The first row of a grid has the smallest y. What is empty or `nan` is no ground.
    """
    header, rows = _rows(path)
    if header is not None:
        return _points_map(path, header, rows, reading)
    if rows.shape[1] == 3 and len(rows) >= _FEWEST_POINTS:
        raise InputError(
            f"{path} has {len(rows)} rows of three numbers: if they are points, put the line x,y,z"
            " in front"
        )
    return _map(path, rows, reading)


def _map(path: Path, heights: np.ndarray, reading: Reading) -> HeightMap:
    if reading.resolution is None:
        raise InputError(
            f"{path} is a table of heights: say its resolution, the edge of a cell [m]"
        )
    if heights.ndim == 3 and 1 in (heights.shape[0], heights.shape[2]):
        heights = heights.squeeze(0 if heights.shape[0] == 1 else 2)
    if heights.dtype.kind not in "fiu" or heights.ndim != 2 or min(heights.shape) < 2:
        raise InputError(
            f"{path} holds {heights.dtype} of shape {heights.shape}; a map is at least 2 x 2"
            " numbers, [rows = y, columns = x]"
        )
    with np.errstate(over="ignore"):
        known = without_no_data(path, heights.astype(np.float64))
        scaled = (known * float(reading.scale)).astype(np.float32)
    require_usable(scaled, reading.resolution, path)
    half = 0.5 * reading.resolution
    return HeightMap(scaled, float(reading.resolution), (half, half))


def _points_map(
    path: Path, header: list[str], rows: Float[np.ndarray, "N K"], reading: Reading
) -> HeightMap:
    """Return the map of points that lie on a grid; where there is none there is no ground."""
    missing = [name for name in "xyz" if name not in header]
    if missing:
        raise InputError(
            f"{path} has the columns {', '.join(header)[:60]}; points need x, y and z, and a grid"
            " of heights has no header"
        )
    x, y, z = (rows[:, header.index(name)] for name in "xyz")
    if not np.isfinite([x, y]).all():
        raise InputError(f"{path} has a point without x or y")
    steps = [np.diff(np.unique(np.round(each, 6))) for each in (x, y)]
    if not all(len(each) for each in steps):
        raise InputError(f"{path} holds points on one line; a map is at least 2 x 2 cells")
    cell = float(min(each.min() for each in steps))
    if reading.resolution is not None and not np.isclose(reading.resolution, cell, rtol=1e-3):
        raise InputError(
            f"{path} has points {cell:g} m apart; --resolution {reading.resolution:g} m is another"
        )
    at = np.array([(x - x.min()) / cell, (y - y.min()) / cell])
    if np.abs(at - np.round(at)).max() > 0.05:
        raise InputError(
            f"{path} has points that lie on no grid of {cell:g} m: it is no height map"
        )
    column, row = np.round(at).astype(np.int64)
    if (row.max() + 1.0) * (column.max() + 1.0) > MAX_CELLS:
        raise InputError(f"{path} spans more than {MAX_CELLS} cells of {cell:g} m")
    heights = np.full((row.max() + 1, column.max() + 1), np.nan, np.float32)
    heights[row, column] = without_no_data(path, z) * reading.scale
    require_usable(heights, cell, path)
    return HeightMap(heights, cell, (float(x.min()), float(y.min())))


def _rows(path: Path) -> tuple[list[str] | None, Float[np.ndarray, "N K"]]:
    """Return the names in the first row, if they are names, and the numbers."""
    content = without_mark(read_bytes(path, MAX_TEXT))
    wide = content[:2] in (codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)  # as spreadsheets save it
    try:
        text = content.decode("utf-16" if wide else "utf-8")
    except UnicodeDecodeError as error:
        raise InputError(f"{path} is not a text table: {error.reason}") from error
    lines = [line for line in text.splitlines() if line.strip() and line.lstrip()[0] != "#"]
    if not lines:
        raise InputError(f"{path} has no rows")
    cells = _split(lines)
    names = [word.strip().strip('"').lower() for word in cells[0]]
    header = None if all(map(_is_number, names)) else names
    body = cells if header is None else cells[1:]
    if not body:
        raise InputError(f"{path} has a header and no rows")
    widths = {len(row) for row in cells}
    if len(widths) > 1:
        raise InputError(f"{path} has rows of {min(widths)} to {max(widths)} columns: no table")
    try:
        values = [
            [np.nan if word.strip().lower() in _NOTHING else float(word) for word in row]
            for row in body
        ]
    except ValueError as error:
        raise InputError(f"{path} holds something that is no number: {str(error)[:80]}") from error
    numbers = np.array(values, np.float64)
    if np.isinf(numbers).any():
        raise InputError(f"{path} holds infinity; leave a cell empty where there is no ground")
    return header, numbers


def _split(lines: list[str]) -> list[list[str]]:
    """Return the words of each line, which a comma, semicolon, tab or spaces separate."""
    first = lines[0]
    if ";" in first:  # then a comma is that of decimals
        lines, mark = [line.replace(",", ".") for line in lines], ";"
    else:
        mark = next((each for each in ("\t", ",") if each in first), None)
    if mark is None:
        return [line.split() for line in lines]
    rows = list(csv.reader(io.StringIO("\n".join(lines)), delimiter=mark))
    if all(row and not row[-1].strip() for row in rows):  # each line ends with the mark
        rows = [row[:-1] for row in rows]
    return rows


def _is_number(word: str) -> bool:
    try:
        float(word)
    except ValueError:
        return word in _NOTHING
    return True
