"""The kinds of files that a terrain is written as, one line each, by the suffix of the name."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from jaxleas.terrain.height_map import HeightMap, write_height_map
from jaxleas.terrain.loading import load_scene
from jaxleas.terrain.polygons import polygon_area_vector
from jaxleas.terrain.reading import Reading
from jaxleas.terrain.scene import write_scene
from jaxleas.terrain.writers.grid_map import write_bag, write_folder, write_mcap
from jaxleas.terrain.writers.mjcf import write_map_mjcf, write_polygons_mjcf
from jaxleas.terrain.writers.rasters import write_asc, write_png, write_tiff
from jaxleas.terrain.writers.stl import write_map_stl, write_polygons_stl
from jaxleas.types import InputError


@dataclass(frozen=True)
class Written:
    """A kind of file that a terrain is written as; each writer returns what it has written.

    Attributes:
        map: writer of a height map; None: such files hold polygons alone.
        polygons: writer of the polygons of a file, as it is read; None: such files hold maps alone.
    """

    map: Callable[[Path, HeightMap], str] | None = None
    polygons: Callable[[Path, Path, Reading], str] | None = None


def _write_npz(path: Path, height_map: HeightMap) -> str:
    write_height_map(path, height_map)
    return "a height map"


def _write_json(path: Path, file: Path, reading: Reading) -> str:
    scene = load_scene(file, reading)
    write_scene(path, scene)
    area = sum(np.linalg.norm(polygon_area_vector(each)) for each in scene.walkable.values())
    return (
        f"{len(scene.surfaces)} surfaces, {area:.2f} m2 for feet, {len(scene.obstacles)} obstacles"
    )


_TIFF = Written(write_tiff)
WRITTEN: dict[str, Written] = {
    ".npz": Written(_write_npz),
    ".json": Written(None, _write_json),
    ".stl": Written(write_map_stl, write_polygons_stl),
    ".xml": Written(write_map_mjcf, write_polygons_mjcf),
    ".png": Written(write_png),
    ".tif": _TIFF,
    ".tiff": _TIFF,
    ".asc": Written(write_asc),
    ".bag": Written(write_bag),
    ".mcap": Written(write_mcap),
    "": Written(write_folder),
}


def written_as(path: Path) -> Written:
    """Return the kind of file that a name states.

    Raises:
        InputError: terrains are not written as such files; the message lists those that they are.
    """
    suffix = path.suffix.lower()
    if suffix == ".db3":
        raise InputError(
            f"{path}: a ROS 2 bag is a folder: give a name without suffix, or one that ends in"
            " .mcap"
        )
    if suffix not in WRITTEN:
        known = ", ".join(each for each in WRITTEN if each)
        raise InputError(
            f"{path}: terrains are not written as '{suffix}' files; the name must end in one of"
            f" {known}, or have no suffix for the folder of a ROS 2 bag"
        )
    return WRITTEN[suffix]
