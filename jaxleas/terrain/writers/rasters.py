"""Height maps as images and text: PNG of 16 bits, GeoTIFF, ESRI ASCII grid."""

import io
from pathlib import Path

import numpy as np

from jaxleas.files import atomic_path, write_bytes, write_text
from jaxleas.terrain.height_map import NO_DATA, HeightMap
from jaxleas.types import InputError, is_ground

WHITE = 65535
FLATTEST = 1e-3
"""Smallest range of heights from black to white [m]."""


def write_png(path: Path, height_map: HeightMap) -> str:
    """Write a PNG of 16 bits, north up, whose transparent black means no ground.

    Returns:
        The options that read it, as an image states neither heights nor sizes.
    """
    from PIL import Image

    heights = height_map.heights[::-1]
    ground = is_ground(heights)
    low, high = float(np.nanmin(heights)), float(np.nanmax(heights))
    high = max(high, low + FLATTEST)
    low -= (high - low) / (WHITE - 1)  # black is left to cells without ground
    level = np.where(ground, (heights - low) / (high - low) * WHITE, 0.0)
    grey = np.clip(np.round(level), ground, WHITE).astype(np.uint16)
    out = io.BytesIO()
    Image.fromarray(grey).save(out, "PNG", transparency=0)
    write_bytes(path, out.getvalue())
    west, _, south, _ = height_map.extent
    return (
        f"grey levels {1e3 * (high - low) / WHITE:.2g} mm apart; it is read with --resolution"
        f" {height_map.resolution:g} --z-min {low:.7g} --z-max {high:.7g}, and {west:g},{south:g}"
        " becomes x = y = 0 then"
    )


def write_tiff(path: Path, height_map: HeightMap) -> str:
    """Write a GeoTIFF of heights in metres, NaN where there is no ground; return its place."""
    try:
        import tifffile
    except ImportError as error:
        raise lacks("tifffile", path) from error
    cell = height_map.resolution
    west, _, _, north = height_map.extent
    tags = [
        (33550, "d", 3, (cell, cell, 0.0)),
        (33922, "d", 6, (0.0, 0.0, 0.0, west, north, 0.0)),
        # The keys: a projected system, pixels are areas, and its unit is the metre (EPSG 9001).
        (34735, "H", 16, (1, 1, 0, 3, 1024, 0, 1, 1, 1025, 0, 1, 1, 3076, 0, 1, 9001)),
        (42113, "s", 0, "nan"),
    ]
    with atomic_path(path) as temporary:
        tifffile.imwrite(temporary, height_map.heights[::-1], extratags=tags, compression="deflate")
    return f"heights in metres, its north-west corner at {west:g},{north:g}"


def write_asc(path: Path, height_map: HeightMap) -> str:
    """Write an ESRI ASCII grid, north up; return the number for no data."""
    x_min, _, y_min, _ = height_map.extent
    rows, columns = height_map.shape
    no_data = NO_DATA[0]
    head = [
        *(f"ncols {columns}", f"nrows {rows}", f"xllcorner {x_min:.9g}", f"yllcorner {y_min:.9g}"),
        *(f"cellsize {height_map.resolution:.9g}", f"NODATA_value {no_data:g}"),
    ]
    heights = np.where(is_ground(height_map.heights), height_map.heights, no_data)[::-1]
    text = io.StringIO()
    np.savetxt(text, heights, fmt="%.6g")
    write_text(path, "\n".join([*head, text.getvalue()]))
    return f"{no_data:g} where there is no ground"


def lacks(library: str, path: Path) -> InputError:
    """Return the error of a library that is not installed."""
    return InputError(
        f"{path} is written by the library {library}, which is not installed:"
        " pip install 'jaxleas[maps]'"
    )
