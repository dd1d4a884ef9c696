"""Meshes to scenes: coplanar neighbours merged into convex polygons (Hertel and Mehlhorn)."""

import logging
from dataclasses import replace
from pathlib import Path

import numpy as np
from jaxtyping import Float, Int

from jaxleas.terrain.agreement import compare, require_agreement
from jaxleas.terrain.bodies import orient, welded
from jaxleas.terrain.cropping import cropped_scene
from jaxleas.terrain.map_formats import MAPS
from jaxleas.terrain.meshes import SUFFIXES, read_triangles
from jaxleas.terrain.places import require_near, shift_of
from jaxleas.terrain.polygons import (
    CONVEXITY_TOLERANCE,
    MIN_AREA,
    PLANARITY_TOLERANCE,
    STANDING_SLOPE,
    VERTICAL_SLOPE,
    convexity_deviation,
    planarity_deviation,
    polygon_area_vector,
)
from jaxleas.terrain.reading import MAPPING, READING, Reading, Up, require_applicable
from jaxleas.terrain.scene import Scene, read_scene
from jaxleas.terrain.shaping import require_rectangle
from jaxleas.terrain.unread import refuse_unread
from jaxleas.types import InputError

_LOG = logging.getLogger("jaxleas")
COPLANAR = 1e-6
"""Neighbours are coplanar if 1 - cosine of the angle between their normals is below this."""


def mesh_to_scene(
    path: str | Path,
    up: Up | None = None,
    scale: float | None = None,
    reading: Reading = READING,
) -> Scene:
    """Return a mesh as a scene of convex polygons; faces that point down are left out.

    Closed bodies are wound outwards first. Neighbours whose union is planar and convex are merged
    greedily into one polygon; the others stay triangles.

    Args:
        path: path of a mesh.
        up: axis of the mesh that points up; None: that of `reading`.
        scale: metres per unit of the file; None: that of `reading`.
        reading: what the file does not state itself, and what is done with it.

    Raises:
        InputError: the file is unreadable, is not a terrain, has no face to stand on, or its
            scene and its height map contradict each other.
    """
    stated = {"up": up, "scale": scale}
    reading = replace(reading, **{name: each for name, each in stated.items() if each is not None})
    triangles = read_triangles(path, reading)
    points, faces = welded(triangles)
    scene = _scene(points, faces)
    found = compare(triangles, scene)
    oriented = orient(points, faces)
    if oriented.turned:
        turned = _scene(points, oriented.faces)
        after = compare(triangles, turned)
        if after.mean_gap < found.mean_gap:  # bodies that pierce each other can mislead
            scene, found = turned, after
            _LOG.warning(
                "%s: %d faces of %d bodies were wound inside out and are turned",
                *(path, oriented.turned, oriented.bodies),
            )
    if not scene.surfaces:
        raise InputError(f"{path} has no face that looks up: are its triangles wound inside out?")
    require_agreement(path, found)
    return scene if reading.crop is None else cropped_scene(scene, reading.crop, str(path))


def _scene(points: Float[np.ndarray, "P 3"], faces: Int[np.ndarray, "N 3"]) -> Scene:
    """Return the faces that look up or sideways, merged: surfaces to stand on, and obstacles."""
    surfaces, obstacles = {}, {}
    for vertices in _merge(points, faces):
        area = polygon_area_vector(vertices)
        slope = area[2] / max(float(np.linalg.norm(area)), 1e-12)
        if np.linalg.norm(area) < MIN_AREA or slope < -VERTICAL_SLOPE:
            continue
        if slope >= STANDING_SLOPE:
            surfaces[f"surface_{len(surfaces)}"] = vertices
        else:
            obstacles[f"obstacle_{len(obstacles)}"] = vertices
    return Scene(surfaces, obstacles)


def load_scene(path: str | Path, reading: Reading = READING) -> Scene:
    """Return a terrain as polygons: a scene, or a mesh.

    Args:
        path: path of a .json scene, or of a mesh.
        reading: what the file does not state itself, and what is done with it.

    Raises:
        InputError: the file has no polygons, or cannot be used.
    """
    suffix = Path(path).suffix.lower()
    if suffix in SUFFIXES:
        return mesh_to_scene(path, reading=reading)
    if suffix in MAPS:
        raise InputError(
            f"{path} is a map of heights; contacts need polygons: a scene (.json) or a mesh"
            f" ({', '.join(SUFFIXES)})"
        )
    refuse_unread(path)
    require_applicable(path, reading, MAPPING, "a scene")
    return read_placed_scene(path, reading)


def has_polygons(path: str | Path) -> bool:
    """Return whether a terrain file holds polygons rather than heights, by its suffix."""
    return Path(path).suffix.lower() in (".json", *SUFFIXES)


def read_placed_scene(path: str | Path, reading: Reading) -> Scene:
    """Return the scene of a .json file, moved and cropped as `reading` says."""
    scene = read_scene(path)
    corners = np.concatenate(scene.polygons)
    low = corners.min(axis=0)
    shift = shift_of(path, reading.origin, (float(low[0]), float(low[1])))
    if shift.any():
        scene = Scene(
            {name: each - shift for name, each in scene.surfaces.items()},
            {name: each - shift for name, each in scene.obstacles.items()},
            {name: each - shift[: each.shape[1]] for name, each in scene.areas.items()},
            scene.touch,
        )
    require_near(path, corners - shift)
    if reading.crop is None:
        return scene
    return cropped_scene(scene, require_rectangle(reading.crop), str(path))


def _merge(
    points: Float[np.ndarray, "P 3"], triangles: Int[np.ndarray, "N 3"]
) -> list[Float[np.ndarray, "V 3"]]:
    """Return convex polygons: both sides of each shared edge are merged if the union is convex."""
    loops: list[list[int] | None] = [face.tolist() for face in triangles]
    normals = np.array([_normal(points[face]) for face in triangles])
    owner = list(range(len(loops)))
    sides: dict[tuple[int, int], int] = {}
    for face, (a, b, c) in enumerate(triangles.tolist()):
        for edge in ((a, b), (b, c), (c, a)):
            sides.setdefault(edge, face)
    for (a, b), face in sides.items():
        other = sides.get((b, a))
        if other is None or a > b or 1.0 - normals[face] @ normals[other] > COPLANAR:
            continue
        left, right = _root(owner, face), _root(owner, other)
        merged = None if left == right else _joined(points, loops[left], loops[right], (a, b))
        if merged is not None:
            loops[left], loops[right], owner[right] = merged, None, left
    return [points[_without_flat_corners(points, loop)] for loop in loops if loop is not None]


def _joined(
    points: np.ndarray, left: list[int] | None, right: list[int] | None, edge: tuple[int, int]
) -> list[int] | None:
    """Return the union of two loops that share an edge, if it is planar and convex."""
    assert left is not None
    assert right is not None
    ends = _rotated_to(left, edge[1]), _rotated_to(right, edge[0])
    if ends[0] is None or ends[1] is None or ends[0][-1] != edge[0] or ends[1][-1] != edge[1]:
        return None
    loop = _without_spurs(ends[0] + ends[1][1:-1])
    if len(set(loop)) != len(loop) or len(loop) < 3:
        return None
    vertices = points[loop]
    planar = planarity_deviation(vertices) <= 0.1 * PLANARITY_TOLERANCE
    convex = planar and convexity_deviation(vertices) <= 0.1 * CONVEXITY_TOLERANCE
    return loop if convex else None


def _rotated_to(loop: list[int], first: int) -> list[int] | None:
    if first not in loop:
        return None
    start = loop.index(first)
    return loop[start:] + loop[:start]


def _without_spurs(loop: list[int]) -> list[int]:
    """Drop paths that go out along an edge and straight back: the seams of two merged loops."""
    index = 0
    while len(loop) > 2 and index < len(loop):
        if loop[index - 1] == loop[(index + 1) % len(loop)]:
            following = (index + 1) % len(loop)
            loop = [v for at, v in enumerate(loop) if at not in (index, following)]
            index = 0
        else:
            index += 1
    return loop


def _without_flat_corners(points: np.ndarray, loop: list[int]) -> list[int]:
    """Drop vertices in the middle of a straight side."""
    vertices = points[loop]
    before, after = (
        vertices - np.roll(vertices, 1, axis=0),
        np.roll(vertices, -1, axis=0) - vertices,
    )
    bend = np.linalg.norm(np.cross(before, after), axis=1)
    length = np.linalg.norm(before, axis=1) * np.linalg.norm(after, axis=1)
    return [vertex for vertex, keep in zip(loop, bend > 1e-6 * length, strict=True) if keep]


def _normal(vertices: np.ndarray) -> np.ndarray:
    area = polygon_area_vector(vertices)
    return area / max(float(np.linalg.norm(area)), 1e-12)


def _root(owner: list[int], face: int) -> int:
    while owner[face] != face:
        owner[face] = owner[owner[face]]
        face = owner[face]
    return face
