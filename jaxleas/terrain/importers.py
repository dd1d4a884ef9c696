"""Real terrains from files: meshes, images, height maps and scenes, converted to height maps."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float

from jaxleas.terrain.cells import padded_groups
from jaxleas.terrain.height_map import (
    HeightMap,
    require_resolution,
    require_usable,
    say_if_tall,
)
from jaxleas.terrain.losses import losses, say_losses
from jaxleas.terrain.meshes.bodies import orient
from jaxleas.terrain.meshes.formats import MESHES
from jaxleas.terrain.meshes.mesh_edges import welded
from jaxleas.terrain.meshes.to_scene import read_placed_scene
from jaxleas.terrain.meshes.triangles import read_triangles
from jaxleas.terrain.rasterise import (
    DEFAULT_RESOLUTION,
    rasterise,
    rasterise_polygons,
)
from jaxleas.terrain.rasters.formats import MAPS
from jaxleas.terrain.rasters.images import import_png
from jaxleas.terrain.reading import MAPPING, READING, Reading, Up, require_applicable
from jaxleas.terrain.shaping import moved, shaped
from jaxleas.terrain.unread import refuse_unread
from jaxleas.types import InputError

__all__ = ["import_mesh", "import_png", "import_terrain", "known_suffixes"]
SEAM = 1e-3
"""Length by which triangles are grown [m]: neighbours in real meshes do not always meet exactly."""
MESH_MARGIN = 0.1
"""Width of void around an imported mesh [m]."""
MOST_ORIENTED = 300_000
"""Number of triangles up to which it is found out which side of them is outside."""


def known_suffixes() -> tuple[str, ...]:
    """Return the suffixes of terrain files."""
    return (".json", *MESHES, *MAPS)


def import_terrain(path: str | Path, reading: Reading = READING, **stated: Any) -> HeightMap:
    """Return the height map of a terrain file, read by its suffix.

    Args:
        path: path of a file of one of the `known_suffixes`, or the folder of a ROS 2 bag.
        reading: what the file does not state itself, and what is done with it.
        stated: values by name that replace those of `reading`, such as resolution=0.02.

    Raises:
        InputError: the suffix is unknown, the file is unusable, or an option is missing or does
            not apply.
    """
    how = replace(reading, **stated)
    path = Path(path)
    suffix = ".mcap" if is_bag(path) else path.suffix.lower()
    if suffix == ".json":
        height_map = _scene_map(path, how)
    elif suffix in MESHES:
        height_map = _mesh_map(path, how)
    elif suffix in MAPS:
        form = MAPS[suffix]
        require_applicable(path, how, form.options, form.title)
        height_map = moved(path, form.read(path, how), how.origin)
        say_if_tall(height_map, path)
    else:
        refuse_unread(path)
        known = ", ".join(known_suffixes())
        raise InputError(f"{path}: unknown terrain file type '{suffix}'; known are {known}")
    return shaped(path, height_map, how)


def import_mesh(
    path: str | Path,
    resolution: float = DEFAULT_RESOLUTION,
    up: Up | None = None,
    scale: float = 1.0,
) -> HeightMap:
    """Return the height map of a mesh: the highest triangle above each cell centre.

    Closed bodies work, as their tops hide their bottoms. Of vertical faces the upper edge counts,
    also where there is no top or it falls between cell centres. Things thinner than a cell that
    are lost all the same, and ground under overhangs, are said with number and size.

    Args:
        path: path of a mesh.
        resolution: edge of a cell [m].
        up: axis of the mesh that points up; z by default, y of a .glb.
        scale: metres per unit of the file.

    Raises:
        InputError: the file is unreadable, is not a terrain, or makes too large a map.
    """
    return _mesh_map(Path(path), Reading(resolution=resolution, up=up, scale=scale))


def _mesh_map(path: Path, how: Reading) -> HeightMap:
    resolution = _cell(path, how)
    triangles = read_triangles(path, how)
    height_map = rasterise_polygons(triangles, resolution, MESH_MARGIN, SEAM, where=str(path))
    require_usable(height_map.heights, resolution, path)
    say_losses(path, losses([_outward(triangles)], height_map), resolution)
    return height_map


def _scene_map(path: Path, how: Reading) -> HeightMap:
    require_applicable(path, how, MAPPING, "a scene")
    resolution = _cell(path, how)
    scene = read_placed_scene(path, how)
    height_map = rasterise(scene, resolution)
    say_losses(path, losses(padded_groups(scene.polygons), height_map), resolution)
    return height_map


def _cell(path: Path, how: Reading) -> float:
    resolution = DEFAULT_RESOLUTION if how.resolution is None else how.resolution
    require_resolution(resolution, path)
    return resolution


def _outward(triangles: Float[np.ndarray, "N 3 3"]) -> Float[np.ndarray, "N 3 3"]:
    """Return triangles wound outwards; of very many, as they are."""
    if len(triangles) > MOST_ORIENTED:
        return triangles
    points, faces = welded(triangles)
    return points[orient(points, faces).faces]


def is_bag(path: Path) -> bool:
    return path.is_dir() and (path / "metadata.yaml").is_file()
