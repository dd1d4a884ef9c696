"""The kinds of files that a terrain is written as, one line each, by the suffix of the name."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import numpy as np

from jaxleas.terrain.height_map import HeightMap, write_height_map
from jaxleas.terrain.loading import load_scene
from jaxleas.terrain.polygons import polygon_area_vector
from jaxleas.terrain.reading import Reading
from jaxleas.terrain.scene_file import write_scene
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

FormatName = Literal["npz", "scene", "stl", "mjcf", "png", "tif", "asc", "bag", "mcap"]
"""Names of the kinds of files that a suffix states."""
_SUFFIX: dict[str, str] = {"scene": ".json", "mjcf": ".xml"}


def named_by_format(file: Path, out: Path | None, format: FormatName | None) -> Path:
    """Return the file to write: what a person named, or the terrain's name as another kind.

    Args:
        file: file of the terrain.
        out: name of the file to write, if it was given.
        format: kind of file to write, if it was given.

    Raises:
        InputError: neither is given, the name states another kind, or the file is the terrain's.
    """
    if format is None:
        if out is None:
            raise InputError("say what to write: --out FILE, or --format such as mjcf")
        return out
    suffix = _SUFFIX.get(format, f".{format}")
    if out is None:
        named = Path(f"{file.stem}{suffix}")
        if named.resolve() == file.resolve():
            raise InputError(f"{named} is the terrain itself: name the file to write with --out")
        return named
    if WRITTEN.get(out.suffix.lower()) is not WRITTEN[suffix]:
        raise InputError(f"--out {out} is no name of the format {format}: let it end in {suffix}")
    return out


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
