"""Any terrain as polygons: scenes and meshes as they are, maps by the surfaces found in them."""

import logging
from dataclasses import replace
from pathlib import Path

from jaxleas.terrain.importers import import_terrain, is_bag
from jaxleas.terrain.meshes.to_scene import mesh_to_scene, read_placed_scene
from jaxleas.terrain.meshes.triangles import SUFFIXES
from jaxleas.terrain.planes.finding import find_surfaces
from jaxleas.terrain.planes.found import FoundSurfaces
from jaxleas.terrain.planes.report import require_surfaces, surfaces_in_words
from jaxleas.terrain.planes.settings import PLANE_SEARCH, PlaneSearch
from jaxleas.terrain.rasters.formats import MAPS
from jaxleas.terrain.reading import MAPPING, READING, Reading, require_applicable
from jaxleas.terrain.scene import Scene
from jaxleas.terrain.unread import refuse_unread
from jaxleas.types import InputError

_LOG = logging.getLogger("jaxleas")


def load_scene(
    path: str | Path, reading: Reading = READING, search: PlaneSearch = PLANE_SEARCH
) -> Scene:
    """Return a terrain as polygons: a scene, a mesh, or the surfaces found in a map.

    What is found in a map, and what is left over, is said in one line.

    Args:
        path: path of a .json scene, of a mesh, or of a map.
        reading: what the file does not state itself, and what is done with it.
        search: what counts as a surface in a map.

    Raises:
        InputError: the file cannot be used, has no polygons and no surface is found in it, or a
            value is given that does not apply to it.
    """
    if is_map(path):
        found = find_surfaces(import_terrain(path, reading), search)
        require_surfaces(path, found)
        _LOG.warning("%s: %s", path, surfaces_in_words(found))
        return scene_of_surfaces(found)
    require_search_of_map(path, search)
    if Path(path).suffix.lower() in SUFFIXES:
        return mesh_to_scene(path, reading=reading)
    refuse_unread(path)
    require_applicable(path, reading, MAPPING, "a scene")
    return read_placed_scene(path, reading)


def scene_of_surfaces(found: FoundSurfaces) -> Scene:
    """Return the surfaces found in a map, for feet, and its high rises, obstacles, as a scene."""
    return Scene(found.polygons, found.obstacles)


def has_polygons(path: str | Path) -> bool:
    """Return whether a terrain file holds polygons rather than heights, by its suffix."""
    return Path(path).suffix.lower() in (".json", *SUFFIXES)


def with_cells(path: str | Path, reading: Reading, cell: float) -> Reading:
    """Return a reading that draws polygons in cells of a size where it states none.

    Args:
        path: path of the terrain file.
        reading: what the file does not state itself.
        cell: edge of a cell [m].
    """
    if reading.resolution is None and has_polygons(path):
        return replace(reading, resolution=cell)
    return reading


def is_map(path: str | Path) -> bool:
    """Return whether a terrain file holds heights rather than polygons, by its suffix."""
    return Path(path).suffix.lower() in MAPS or is_bag(Path(path))


def require_search_of_map(path: str | Path, search: PlaneSearch) -> None:
    """Refuse values for a search in a map, where there is no map.

    Raises:
        InputError: a value was given that does not apply; the message names it.
    """
    given = [f"--{name.replace('_', '-')}" for name in search.given]
    if given and not is_map(path):
        verb = "do" if len(given) > 1 else "does"
        raise InputError(
            f"{' and '.join(given)} {verb} not apply to {path}: surfaces are sought in maps of"
            " heights alone; this file states its own"
        )
