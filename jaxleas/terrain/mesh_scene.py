"""Meshes to scenes: coplanar neighbours merged into convex polygons (Hertel and Mehlhorn)."""

from pathlib import Path

import numpy as np
from jaxtyping import Float, Int

from jaxleas.terrain.meshes import SUFFIXES, read_triangles
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
from jaxleas.terrain.reading import Up
from jaxleas.terrain.scene import Scene, read_scene
from jaxleas.types.errors import InputError

WELD = 1e-5
"""Distance below which vertices are merged [m]."""
COPLANAR = 1e-6
"""Neighbours are coplanar if 1 - cosine of the angle between their normals is below this."""


def mesh_to_scene(path: str | Path, up: Up = "z", scale: float = 1.0) -> Scene:
    """Return a mesh as a scene of convex polygons; faces that point down are left out.

    Neighbours whose union is planar and convex are merged greedily into one polygon; the others
    stay triangles.

    Raises:
        InputError: the file is unreadable, is not a terrain, or has no face to stand on.
    """
    corners = read_triangles(path, up, scale).reshape(-1, 3)
    _, first, index = np.unique(
        np.round(corners / WELD).astype(np.int64), axis=0, return_index=True, return_inverse=True
    )
    surfaces, obstacles = {}, {}
    for vertices in _merge(corners[first], index.reshape(-1, 3)):
        area = polygon_area_vector(vertices)
        slope = area[2] / max(float(np.linalg.norm(area)), 1e-12)
        if np.linalg.norm(area) < MIN_AREA or slope < -VERTICAL_SLOPE:
            continue
        if slope >= STANDING_SLOPE:
            surfaces[f"surface_{len(surfaces)}"] = vertices
        else:
            obstacles[f"obstacle_{len(obstacles)}"] = vertices
    if not surfaces:
        raise InputError(f"{path} has no face that looks up: are its triangles wound inside out?")
    return Scene(surfaces, obstacles)


def load_scene(path: str | Path) -> Scene:
    """Return a terrain as polygons: a scene, or a mesh in metres with z up.

    Args:
        path: path of a .json scene, .stl or .obj mesh.

    Raises:
        InputError: the file has no polygons, or cannot be used.
    """
    suffix = Path(path).suffix.lower()
    if suffix in SUFFIXES:
        return mesh_to_scene(path)
    if suffix in (".npz", ".png"):
        raise InputError(
            f"{path} is a map of heights; contacts need polygons: a scene (.json) or a mesh"
            f" ({', '.join(SUFFIXES)})"
        )
    return read_scene(path)


def _merge(
    points: Float[np.ndarray, "P 3"], triangles: Int[np.ndarray, "N 3"]
) -> list[Float[np.ndarray, "V 3"]]:
    """Return convex polygons: both sides of each shared edge are merged if the union is convex."""
    triangles = np.array([face for face in triangles if len(set(face)) == 3]).reshape(-1, 3)
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
