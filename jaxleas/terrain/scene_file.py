"""Scenes as JSON files: read from strangers, checked polygon by polygon, and written."""

import difflib
from pathlib import Path
from typing import Any, get_args

import numpy as np

from jaxleas.files import (
    MAX_JSON_BYTES,
    read_json,
    refuse_misspelt_keys,
    require_version,
    to_json,
    write_text,
)
from jaxleas.terrain.mending import counter_clockwise, flattened, turned_up, without_repeats
from jaxleas.terrain.polygons import (
    VERTICAL_SLOPE,
    is_vertical,
    require_any_orientation,
    require_convex_polygon,
    upwardness,
)
from jaxleas.terrain.scene import Scene, Touch
from jaxleas.types import InputError

VERSION = 1
MAX_CORNERS = 10_000_000
KNOWN_KEYS = ("version", "surfaces", "obstacles", "areas", "touch")


def read_scene(path: str | Path) -> Scene:
    """Read a scene from JSON: `surfaces`, optionally `obstacles`, `areas`, `touch` and `version`.

    Rings closed by their first vertex, clockwise floors and obstacles, and vertices a few
    millimetres off their plane are mended; the latter two are said.

    Raises:
        InputError: the file cannot be used, or one polygon in it, which the message names.
    """
    content = read_json(path)
    if not isinstance(content, dict) or "surfaces" not in content:
        raise InputError(f"{path} is not a scene: it needs an object with the key 'surfaces'")
    refuse_misspelt_keys(path, content, KNOWN_KEYS)
    require_version(content, VERSION, path)
    touch = _touch(path, content)
    surfaces = _polygons(path, content, "surfaces", dimensions=(3,))
    obstacles = _polygons(path, content, "obstacles", dimensions=(3,))
    areas = _polygons(path, content, "areas", dimensions=(2, 3))
    scene = Scene(
        surfaces=turned_up(path, surfaces, touch),
        obstacles=counter_clockwise(path, "obstacle", obstacles),
        areas=counter_clockwise(path, "area", areas),
        touch=touch,
    )
    if not scene.surfaces:
        raise InputError(f"{path} has no surfaces: nothing can stand anywhere")
    require_valid(scene, path)
    if not scene.walkable:
        raise InputError(_nowhere(scene, path))
    return scene


def write_scene(path: str | Path, scene: Scene) -> None:
    """Write a scene as JSON, whole or not at all; coordinates to a micrometre.

    Raises:
        InputError: the file would be larger than scenes that are read.
    """
    groups = {"surfaces": scene.surfaces, "obstacles": scene.obstacles, "areas": scene.areas}
    lists = {
        group: {name: np.round(vertices, 6).tolist() for name, vertices in polygons.items()}
        for group, polygons in groups.items()
    }
    touch = {"touch": dict(scene.touch)} if scene.touch else {}
    text = to_json({"version": VERSION, **lists, **touch})
    if len(text) > MAX_JSON_BYTES:
        raise InputError(
            f"{path} would hold {len(scene.polygons)} polygons in {len(text) / 2**20:.0f} MiB, more"
            f" than the {MAX_JSON_BYTES // 2**20} MiB that are read: give --crop, or decimate the"
            " mesh"
        )
    write_text(path, text)


def require_valid(scene: Scene, where: str | Path) -> None:
    """Refuse a scene with a polygon that is not planar and convex, or has an impossible `touch`."""
    for name, vertices in scene.surfaces.items():
        require_any_orientation(vertices, f"{where}: surface '{name}'")
        if scene.touch.get(name, "palms") != "palms" and upwardness(vertices) <= VERTICAL_SLOPE:
            raise InputError(
                f"{where}: touch says '{scene.touch[name]}' of surface '{name}', which is vertical"
                " or looks down: feet cannot stand on it; say 'palms'"
            )
    for name, vertices in scene.obstacles.items():
        require_convex_polygon(vertices, f"{where}: obstacle '{name}'", wall=True)
    for name, vertices in scene.areas.items():
        lifted = np.column_stack([vertices[:, :2], np.zeros(len(vertices))])
        require_convex_polygon(lifted, f"{where}: area '{name}'", wall=False)


def _nowhere(scene: Scene, path: str | Path) -> str:
    """Return the reason why feet can stand nowhere, from the first surface."""
    name, vertices = next(iter(scene.surfaces.items()))
    if name in scene.touch:
        return f"{path} has no surface that feet may touch: touch says 'palms' of all"
    if is_vertical(vertices):
        why = "is vertical; list it as an obstacle, and what is stood on as a surface"
    elif upwardness(vertices) < 0.0:
        why = "is clockwise seen from above; reverse its vertices, if it is no ceiling"
    else:
        why = "is steeper than 60 degrees; say 'feet' of it in 'touch', if it can be stood on"
    return f"{path} has no surface that feet may touch: surface '{name}' {why}"


def _touch(path: str | Path, content: dict[str, Any]) -> dict[str, Touch]:
    said = content.get("touch", {})
    if not isinstance(said, dict):
        raise InputError(f"{path}: 'touch' must be an object of surface: who may touch it")
    surfaces = content["surfaces"]
    for name, who in said.items():
        if name not in surfaces:
            close = difflib.get_close_matches(name, surfaces, n=1)
            meant = f"; perhaps you meant '{close[0]}'" if close else ""
            raise InputError(f"{path}: 'touch' names '{name}', which is no surface{meant}")
        if who not in get_args(Touch):
            raise InputError(
                f"{path}: touch of surface '{name}' is {who!r:.60}; it must be one of"
                f" {', '.join(get_args(Touch))}"
            )
    return said


def _polygons(
    path: str | Path, content: dict[str, Any], key: str, dimensions: tuple[int, ...]
) -> dict[str, np.ndarray]:
    group = content.get(key, {})
    if not isinstance(group, dict):
        raise InputError(f"{path}: '{key}' must be an object of name: [[x, y, z], ...]")
    polygons = {name: _polygon(path, key, name, each, dimensions) for name, each in group.items()}
    # They become one array, padded to the largest polygon (terrain/cells.py).
    corners = len(polygons) * max((len(each) for each in polygons.values()), default=0)
    if corners > MAX_CORNERS:
        raise InputError(
            f"{path} has {len(polygons)} {key}, the largest of {corners // len(polygons)} corners:"
            f" more than {MAX_CORNERS} corners in all"
        )
    return polygons


def _polygon(
    path: str | Path, key: str, name: str, value: Any, dimensions: tuple[int, ...]
) -> np.ndarray:
    wanted = " or ".join(str(number) for number in dimensions)
    problem = f"{path}: {key} '{name}' must be a list of vertices of {wanted} numbers each"
    if not isinstance(value, list) or not all(isinstance(vertex, list) for vertex in value):
        raise InputError(problem)
    numbers = [number for vertex in value for number in vertex]
    if any(isinstance(n, bool) or not isinstance(n, int | float) for n in numbers):
        raise InputError(problem)
    if len({len(vertex) for vertex in value}) > 1 or (value and len(value[0]) not in dimensions):
        raise InputError(problem)
    if not all(abs(number) < 1e6 for number in numbers):
        raise InputError(f"{path}: {key} '{name}' has a coordinate beyond 1000 km")
    vertices = np.array(value, dtype=np.float64).reshape(len(value), -1 if value else 3)
    vertices = without_repeats(vertices)
    return flattened(path, name, vertices) if vertices.shape[1] == 3 else vertices
