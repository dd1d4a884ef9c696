"""PNG images as grey levels: any colour mode and depth; transparent pixels are no ground."""

import io
import logging
import struct
import zlib
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from jaxtyping import Bool, Float

from jaxleas.files import read_bytes
from jaxleas.terrain.height_map import MAX_CELLS, HeightMap, require_resolution, require_usable
from jaxleas.terrain.rasters.deep_png import decode_deep_colour
from jaxleas.terrain.reading import Reading
from jaxleas.types import InputError

_LOG = logging.getLogger("jaxleas")
MAX_PNG_BYTES = 2**28
GREY = np.array([0.299, 0.587, 0.114])
"""Weights of red, green and blue in grey (ITU-R BT.601), as OpenCV and Pillow have them."""
FINE_STEP = 1e-3
"""Distance of grey levels up to which nothing is lost that a foot would notice [m]."""
_PALETTE, _ALPHA = 3, 4  # colour type of a PNG; bit of those with an alpha channel


@dataclass(frozen=True)
class Levels:
    """Grey levels of an image, its top row first.

    Attributes:
        values: levels, 0 to `white`.
        white: level of white.
        clear: which pixels are transparent.
        levels: number of different levels that the file can state.
    """

    values: Float[np.ndarray, "rows columns"]
    white: float
    clear: Bool[np.ndarray, "rows columns"]
    levels: int


def read_png(path: str | Path, reading: Reading) -> HeightMap:
    """Return the height map of an image that needs `resolution`, `z_min` and `z_max`."""
    if reading.resolution is None or reading.z_min is None or reading.z_max is None:
        raise InputError(f"{path} is an image: say its resolution, z_min and z_max [m]")
    return import_png(path, reading.resolution, reading.z_min, reading.z_max, reading.zero_is_void)


def import_png(
    path: str | Path, resolution: float, z_min: float, z_max: float, zero_is_void: bool = False
) -> HeightMap:
    """Return the height map of an image: black is z_min, white is z_max, north up.

    Colours count by their grey. Pixels less than half opaque are no ground. How far neighbouring
    grey levels lie apart is said.

    Args:
        path: path of a PNG file, whose last row is the map's first.
        resolution: edge of a pixel [m].
        z_min: height of black [m].
        z_max: height of white [m].
        zero_is_void: whether black means that there is no ground.

    Raises:
        InputError: the file is unreadable or too large, or z_min >= z_max.
    """
    require_resolution(resolution, path)
    if not (np.isfinite([z_min, z_max]).all() and z_min < z_max):
        raise InputError(f"{path}: z_min {z_min:g} m must be below z_max {z_max:g} m")
    image = read_levels(Path(path))
    heights: np.ndarray = np.empty(image.values.shape, np.float32)
    for row, line in enumerate(image.values[::-1]):  # in float64, row by row
        heights[row] = z_min + (z_max - z_min) * (line / image.white)
    clear = image.clear[::-1]
    if zero_is_void:
        clear = clear | (image.values[::-1] == 0)
    heights[clear] = np.nan
    if min(heights.shape) < 2:
        rows, columns = heights.shape
        raise InputError(f"{path} has {columns} x {rows} pixels; at least 2 x 2")
    require_usable(heights, resolution, path)
    say_step(path, image.levels, z_max - z_min)
    return HeightMap(heights, float(resolution), (0.5 * resolution, 0.5 * resolution))


def say_step(path: str | Path, levels: int, span: float) -> None:
    """Say how far the grey levels of an image lie apart.

    Args:
        path: path of the image.
        levels: number of different levels that the file can state.
        span: height of white above black [m].
    """
    step = span / (levels - 1)
    lost = ": heights between them are lost" if step > FINE_STEP else ""
    _LOG.warning("%s has %d grey levels, %.2g mm apart%s", path, levels, 1000.0 * step, lost)


def read_levels(path: Path) -> Levels:
    """Return the grey levels of a PNG file.

    Raises:
        InputError: the file is not a PNG, damaged, or too large.
    """
    content = read_bytes(path, MAX_PNG_BYTES)
    width, height = _png_size(path, content)
    if width * height > MAX_CELLS:
        raise InputError(f"{path} has {width} x {height} pixels, more than {MAX_CELLS}")
    depth, kind = content[24], content[25]
    # Pillow's errors for chunks that are cut short or hold something else; it bounds their texts.
    try:
        if depth == 16 and kind not in (0, _PALETTE):
            pixels = decode_deep_colour(content)
        else:
            pixels = _decoded(path, content, (width, height))
    except (OSError, ValueError, SyntaxError, IndexError, struct.error, zlib.error) as error:
        words = " ".join(str(error).split())[:100]
        raise InputError(f"{path} is not a readable PNG image: {words}") from error
    white = 65535.0 if pixels.dtype != np.uint8 else 255.0
    colours, alpha = pixels[..., :-1], pixels[..., -1]
    levels = 2 ** (8 if kind == _PALETTE else depth)
    return Levels(_grey(path, colours), white, alpha < 0.5 * white, levels)


def _decoded(path: Path, content: bytes, size: tuple[int, int]) -> np.ndarray:
    """Return the pixels as Pillow reads them: grey or red, green and blue; then alpha."""
    from PIL import Image

    with Image.open(io.BytesIO(content), formats=("PNG",)) as image:
        if image.size != size:
            raise InputError(f"{path} is not a readable PNG image: it states two sizes")
        clear = image.info.get("transparency")
        if image.mode.startswith("I"):
            grey = np.asarray(image).astype(np.uint16).reshape(size[::-1])
            opaque = np.full_like(grey, 65535)
            if isinstance(clear, int):
                opaque[grey == clear] = 0
            return np.stack([grey, opaque], axis=-1)
        has_alpha = clear is not None or image.mode in ("LA", "PA", "RGBA")
        grey = image.mode in ("1", "L", "LA")
        mode = ("LA" if has_alpha else "L") if grey else ("RGBA" if has_alpha else "RGB")
        pixels = np.asarray(image.convert(mode)).reshape(*size[::-1], -1)
    if has_alpha:
        return pixels
    return np.concatenate([pixels, np.full_like(pixels[..., :1], 255)], axis=-1)


def _grey(path: Path, colours: np.ndarray) -> Float[np.ndarray, "rows columns"]:
    first = colours[..., 0]
    if all((colours[..., other] == first).all() for other in range(1, colours.shape[-1])):
        return first.astype(np.float64) if first.dtype == np.uint8 else first
    _LOG.warning("%s is coloured: its colours are weighed as grey", path)
    return colours @ GREY


def _png_size(path: Path, content: bytes) -> tuple[int, int]:
    """Return width and height from the first chunk, before Pillow allocates memory."""
    if content[:8] != b"\x89PNG\r\n\x1a\n" or content[12:16] != b"IHDR" or len(content) < 29:
        raise InputError(f"{path} is not a readable PNG image: it does not begin like one")
    return int.from_bytes(content[16:20], "big"), int.from_bytes(content[20:24], "big")
