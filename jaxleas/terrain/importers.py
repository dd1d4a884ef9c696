"""Real terrains from files: meshes, images, height maps and scenes, converted to height maps."""

import io
import struct
import zlib
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Int

from jaxleas.files import read_bytes
from jaxleas.terrain.height_map import (
    MAX_CELLS,
    HeightMap,
    read_height_map,
    require_resolution,
    require_usable,
)
from jaxleas.terrain.meshes import SUFFIXES, read_triangles
from jaxleas.terrain.rasterise import DEFAULT_RESOLUTION, rasterise, rasterise_polygons
from jaxleas.terrain.reading import READING, Reading, Up
from jaxleas.terrain.scene import read_scene
from jaxleas.types.errors import InputError

SEAM = 1e-3
"""Length by which triangles are grown [m]: neighbours in real meshes do not always meet exactly."""
MESH_MARGIN = 0.1
"""Width of void around an imported mesh [m]."""
WHITE = 65535
MAX_PNG_BYTES = 2**28


def import_terrain(path: str | Path, reading: Reading = READING, **stated: Any) -> HeightMap:
    """Return the height map of a terrain file, read by its suffix.

    Args:
        path: path of a .npz height map, .json scene, .stl or .obj mesh, or 16-bit grey .png.
        reading: what the file does not state itself.
        stated: values by name that replace those of `reading`, such as resolution=0.02.

    Raises:
        InputError: the suffix is unknown, the file is unusable, or an option is missing.
    """
    how = replace(reading, **stated)
    suffix = Path(path).suffix.lower()
    if suffix == ".npz":
        height_map = read_height_map(path)
        if how.resolution is not None and not np.isclose(how.resolution, height_map.resolution):
            raise InputError(
                f"{path} is a map of {height_map.resolution:g} m cells; "
                f"it cannot be read at a resolution of {how.resolution:g} m"
            )
        return height_map
    cell = DEFAULT_RESOLUTION if how.resolution is None else how.resolution
    if suffix == ".json":
        return rasterise(read_scene(path), cell)
    if suffix in SUFFIXES:
        return import_mesh(path, cell, how.up, how.scale)
    if suffix == ".png":
        if how.resolution is None or how.z_min is None or how.z_max is None:
            raise InputError(f"{path} is an image: say its resolution, z_min and z_max [m]")
        return import_png(path, how.resolution, how.z_min, how.z_max, how.zero_is_void)
    known = ", ".join((".npz", ".json", *SUFFIXES, ".png"))
    raise InputError(f"{path}: unknown terrain file type '{suffix}'; known are {known}")


def import_mesh(
    path: str | Path, resolution: float = DEFAULT_RESOLUTION, up: Up = "z", scale: float = 1.0
) -> HeightMap:
    """Return the height map of a mesh: the highest triangle above each cell centre.

    Closed bodies work, as their tops hide their bottoms; vertical faces have no height. Objects
    thinner than a cell, such as a handrail, can fall between cell centres: use a finer resolution.

    Args:
        path: path of an STL or OBJ file.
        resolution: edge of a cell [m].
        up: axis of the mesh that points up.
        scale: metres per unit of the file.

    Raises:
        InputError: the file is unreadable, is not a terrain, or makes too large a map.
    """
    require_resolution(resolution, path)
    triangles = read_triangles(path, up, scale)
    height_map = rasterise_polygons(triangles, resolution, MESH_MARGIN, SEAM, where=str(path))
    require_usable(height_map.heights, resolution, path)
    return height_map


def import_png(
    path: str | Path, resolution: float, z_min: float, z_max: float, zero_is_void: bool = False
) -> HeightMap:
    """Return the height map of a 16-bit grey image: black is z_min, white is z_max, north up.

    Args:
        path: path of a 16-bit greyscale PNG file, whose last row is the map's first.
        resolution: edge of a pixel [m].
        z_min: height of value 0 [m].
        z_max: height of value 65535 [m].
        zero_is_void: whether value 0 means that there is no ground.

    Raises:
        InputError: the file is unreadable, of another mode, too large, or z_min >= z_max.
    """
    require_resolution(resolution, path)
    if not (np.isfinite([z_min, z_max]).all() and z_min < z_max):
        raise InputError(f"{path}: z_min {z_min:g} m must be below z_max {z_max:g} m")
    values = np.flipud(_grey_values(Path(path)))
    heights: np.ndarray = np.empty(values.shape, np.float32)
    for row, line in enumerate(values):  # in float64, row by row
        heights[row] = z_min + (z_max - z_min) * (line / WHITE)
    if zero_is_void:
        heights[values == 0] = np.nan
    if min(heights.shape) < 2:
        rows, columns = values.shape
        raise InputError(f"{path} has {columns} x {rows} pixels; at least 2 x 2")
    require_usable(heights, resolution, path)
    return HeightMap(heights, float(resolution), (0.5 * resolution, 0.5 * resolution))


def _grey_values(path: Path) -> Int[np.ndarray, "rows columns"]:
    from PIL import Image

    content = read_bytes(path, MAX_PNG_BYTES)
    width, height = _png_size(path, content)
    if width * height > MAX_CELLS:
        raise InputError(f"{path} has {width} x {height} pixels, more than {MAX_CELLS}")
    try:
        with Image.open(io.BytesIO(content), formats=("PNG",)) as image:
            if image.size != (width, height):
                raise InputError(f"{path} is not a readable PNG image: it states two sizes")
            if not image.mode.startswith("I"):
                raise InputError(
                    f"{path} is a PNG of mode {image.mode}; heights need 16-bit grey (mode I;16)"
                )
            return np.asarray(image).astype(np.uint16).reshape(height, width)
    # Pillow's errors for chunks that are cut short or hold something else; it bounds their texts.
    except (OSError, ValueError, SyntaxError, IndexError, struct.error, zlib.error) as error:
        words = " ".join(str(error).split())[:100]
        raise InputError(f"{path} is not a readable PNG image: {words}") from error


def _png_size(path: Path, content: bytes) -> tuple[int, int]:
    """Return width and height from the first chunk, before Pillow allocates memory."""
    if content[:8] != b"\x89PNG\r\n\x1a\n" or content[12:16] != b"IHDR":
        raise InputError(f"{path} is not a readable PNG image: it does not begin like one")
    return int.from_bytes(content[16:20], "big"), int.from_bytes(content[20:24], "big")
