"""TIFF and GeoTIFF files as heights, by tifffile."""

import re
from pathlib import Path
from typing import Any

import numpy as np

from jaxleas.terrain.foreign.answers import Answer, RefusedError

MAX_CELLS = 64_000_000
_GEOGRAPHIC = 2  # GTModelTypeGeoKey of maps in degrees
_PLACE = {33550: "ModelPixelScale", 33922: "ModelTiepoint", 34264: "ModelTransformation"}
"""Tags that may stand without keys that say what they mean."""
_GDAL = {"metadata": 42112, "no data": 42113}
"""Tags of GDAL, whose values are texts."""
_MASK = 4
"""Bit of the kind of an image that says where another one is valid."""
_FEET = {9002: 0.3048, 9003: 1200.0 / 3937.0}
"""Metres per linear unit, by its EPSG code."""


def load() -> None:
    """Load the libraries."""
    import imagecodecs  # noqa: F401
    import tifffile  # noqa: F401


def read(path: Path, options: dict[str, Any]) -> Answer:
    """Return `heights` as the file has them, its south row first, NaN where it states no data.

    Further arrays: `whole`, whether its values are whole numbers, and `levels`, how many of them
    its bits can state; if it is georeferenced also `cell` [m] and `corner`, x and y of the middle
    of the south-west cell [m].
    """
    import tifffile

    del options
    notes: list[str] = []
    with tifffile.TiffFile(path) as file:
        page = file.pages[0]
        if not isinstance(page, tifffile.TiffPage):
            raise RefusedError("has no image")
        if page.imagewidth * page.imagelength > MAX_CELLS:
            raise RefusedError(
                f"has {page.imagewidth} x {page.imagelength} pixels, more than {MAX_CELLS}"
            )
        tags = {name: page.tags[code].value for code, name in _PLACE.items() if code in page.tags}
        tags |= page.geotiff_tags or {}
        values = page.asarray()
        stated = {
            name: str(page.tags[code].value) for name, code in _GDAL.items() if code in page.tags
        }
        bits = int(page.bitspersample)
        others = [each for each in file.pages[1:] if isinstance(each, tifffile.TiffPage)]
        masks = [each for each in others if int(each.subfiletype) & _MASK]
        mask = masks[0].asarray() if masks and masks[0].shape == values.shape[:2] else None
        if len(file.pages) > 1 + len(masks):
            notes.append(f"has {len(file.pages) - len(masks)} images; the first one is read")
    if values.ndim == 3:
        values, more = _one_band(values)
        notes.extend(more)
    if values.ndim != 2 or values.dtype.kind not in "fiu":
        raise RefusedError(f"holds {values.dtype} of shape {values.shape}; a map has one band")
    heights = _heights(values, stated.get("no data"), mask)
    scale, offset = _scale(stated.get("metadata", ""))
    if (scale, offset) != (1.0, 0.0):
        notes.append(f"states a scale of {scale:g} and an offset of {offset:g}, which are applied")
        heights = scale * heights + offset
    whole = values.dtype.kind != "f" and (scale, offset) == (1.0, 0.0)
    place, south_first = _place(tags, values.shape)
    if south_first:
        notes.append("holds its south row first, and is read so")
    heights = heights if south_first else heights[::-1]
    return Answer({"heights": heights, "whole": whole, "levels": 2.0**bits} | place, notes)


def _heights(values: np.ndarray, no_data: str | None, mask: np.ndarray | None) -> np.ndarray:
    """Return values as heights, NaN where they are the stated number or lie outside the mask."""
    heights = values.astype(np.float64)
    if no_data is not None:
        number = float(no_data.strip(" \0\n"))
        if np.isfinite(number):  # in the image's own type, which may have rounded it
            with np.errstate(over="ignore", invalid="ignore"):
                heights[values == np.asarray(number).astype(values.dtype)] = np.nan
    if mask is not None:
        heights[mask == 0] = np.nan
    return heights


def _scale(metadata: str) -> tuple[float, float]:
    """Return scale and offset of the first band that GDAL's metadata state; 1 and 0 if none."""
    found = {"scale": 1.0, "offset": 0.0}
    for item in re.findall(r"<Item\b([^>]*)>([^<]*)</Item>", metadata):
        role = re.search(r'\brole="(scale|offset)"', item[0])
        if role and 'sample="0"' in item[0]:
            found[role[1]] = float(item[1])
    if not np.isfinite(list(found.values())).all():
        raise RefusedError("states a scale or an offset that is no number")
    return found["scale"], found["offset"]


def _one_band(values: np.ndarray) -> tuple[np.ndarray, list[str]]:
    """Return the grey of an image of several bands, bands last or first."""
    if values.shape[-1] > 4 >= values.shape[0]:
        values = np.moveaxis(values, 0, -1)
    if values.shape[-1] > 4:
        raise RefusedError(f"has {values.shape[-1]} bands; a map has one")
    if values.shape[-1] == 2:
        return values[..., 0], ["has 2 bands; the first one is read"]
    if values.shape[-1] < 3 or all((values[..., k] == values[..., 0]).all() for k in (1, 2)):
        return values[..., 0], []
    return values[..., :3] @ np.array([0.299, 0.587, 0.114]), ["is coloured; its grey is read"]


def _place(tags: dict[str, Any], shape: tuple[int, ...]) -> tuple[dict[str, Any], bool]:
    """Return the edge of a cell and the middle of the south-west one, if the file states them.

    Also returns whether the first row is the south one.
    """
    scale, tie = tags.get("ModelPixelScale"), tags.get("ModelTiepoint")
    matrix = tags.get("ModelTransformation")
    if matrix is not None:
        matrix = np.asarray(matrix, np.float64).reshape(4, 4)
        if abs(matrix[0, 1]) + abs(matrix[1, 0]) > 1e-9 * abs(matrix[0, 0]):
            raise RefusedError("is turned against its axes; warp it to them first")
        step = matrix[0, 0], -matrix[1, 1]
        left, top = matrix[0, 3], matrix[1, 3]
    elif scale is not None and tie is not None:
        step = float(scale[0]), float(scale[1])
        tie = np.asarray(tie, np.float64).reshape(-1)[:6]
        left, top = tie[3] - tie[0] * step[0], tie[4] + tie[1] * step[1]
    else:
        return {}, False
    if int(tags.get("GTModelTypeGeoKey", 0)) == _GEOGRAPHIC:
        raise RefusedError("is in degrees; warp it to metres first, such as UTM")
    unit = _FEET.get(int(tags.get("ProjLinearUnitsGeoKey", 9001)), 1.0)
    if step[0] < 0.0:
        raise RefusedError("runs from east to west; warp it to rows from west to east first")
    if not (step[0] > 0.0 and abs(step[0] - abs(step[1])) < 1e-3 * step[0]):
        raise RefusedError(f"has cells of {step[0]:g} x {abs(step[1]):g}; a map has square ones")
    point = int(tags.get("GTRasterTypeGeoKey", 1)) == 2  # then the tie is a middle, not a corner
    half = 0.0 if point else 0.5
    south_first = step[1] < 0.0
    south = 0 if south_first else shape[0] - 1
    corner = np.array([left + half * step[0], top - (south + half) * step[1]])
    return {"cell": step[0] * unit, "corner": corner * unit}, south_first
