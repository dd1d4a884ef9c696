"""Terrain as triangles for the page, and its intersection with rays."""

from collections.abc import Iterable
from typing import NamedTuple

import numpy as np
from jaxtyping import Float, Int

from jaxleas.terrain import HeightMap
from jaxleas.types import is_ground

MOST_CELLS = 250_000
"""Larger maps are thinned before they are sent: a browser on an old laptop must turn them
smoothly."""
LIFT = 0.004
"""Height of rims above their polygons, which would otherwise show through [m]."""


class Mesh(NamedTuple):
    """A mesh of triangles.

    Attributes:
        vertices: corners [m].
        faces: indices of the three corners of each triangle, counter-clockwise from outside.
    """

    vertices: Float[np.ndarray, "V 3"]
    faces: Int[np.ndarray, "F 3"]


def mesh_of_polygons(polygons: Iterable[Float[np.ndarray, "V 3"]]) -> Mesh:
    """Return convex polygons as fans of triangles."""
    vertices: list[np.ndarray] = []
    faces: list[tuple[int, int, int]] = []
    for polygon in polygons:
        first = sum(map(len, vertices))
        vertices.append(polygon)
        faces += [(first, first + k, first + k + 1) for k in range(1, len(polygon) - 1)]
    return Mesh(np.concatenate([np.zeros((0, 3)), *vertices]), np.reshape(faces, (-1, 3)))


def mesh_of_edges(polygons: Iterable[Float[np.ndarray, "V 3"]], width: float) -> Mesh:
    """Return the rims of convex polygons as strips, just above them.

    Args:
        polygons: polygons, counter-clockwise from outside.
        width: width of a strip [m]; smaller where a polygon is too small for it.
    """
    quads: list[np.ndarray] = [np.zeros((0, 4, 3))]
    for polygon in polygons:
        following, before = np.roll(polygon, -1, axis=0), np.roll(polygon, 1, axis=0)
        ahead, back = following - polygon, before - polygon
        length = np.linalg.norm(ahead, axis=1, keepdims=True)
        normal = np.cross(ahead, back)
        double_area = np.linalg.norm(np.cross(ahead, back), axis=1, keepdims=True)
        if length.min() < 1e-9 or double_area.min() < 1e-12:
            continue  # corners on one line have no inner side
        sine = double_area / (length * np.roll(length, 1, axis=0))
        narrow = min(width, 0.2 * float((double_area / length).min()))
        inner = polygon + narrow / sine * (ahead / length + back / np.roll(length, 1, axis=0))
        up = LIFT * normal[0] / double_area[0]
        corners = [polygon, following, np.roll(inner, -1, axis=0), inner]
        quads.append(np.stack(corners, axis=1) + up)
    return _mesh_of_quads(np.concatenate(quads))


def mesh_of_map(terrain: HeightMap) -> Mesh:
    """Return a height map as level cells joined by upright walls: what the policy observes.

    A wall joins two neighbouring cells of different height; there are no walls next to the void.
    Maps of more than `MOST_CELLS` are thinned: each block of cells shows its highest cell.
    """
    heights, resolution, origin = _thinned(terrain)
    rows, columns = heights.shape
    half = 0.5 * resolution
    x = origin[0] + resolution * np.arange(columns)
    y = origin[1] + resolution * np.arange(rows)
    centre_x, centre_y = np.meshgrid(x, y)
    quads = [_tops(heights, centre_x, centre_y, half)]
    quads.append(_walls(heights, centre_x, centre_y, half))
    # Walls along y are those along x of the transposed map.
    quads.append(_walls(heights.T, centre_y.T, centre_x.T, half)[:, ::-1, [1, 0, 2]])
    return _mesh_of_quads(np.concatenate(quads))


def _mesh_of_quads(quads: Float[np.ndarray, "Q 4 3"]) -> Mesh:
    first = 4 * np.arange(len(quads))[:, None, None]
    faces = first + np.array([[0, 1, 2], [0, 2, 3]])
    return Mesh(quads.reshape(-1, 3), faces.reshape(-1, 3))


def _thinned(terrain: HeightMap) -> tuple[np.ndarray, float, tuple[float, float]]:
    step = int(np.ceil(np.sqrt(terrain.heights.size / MOST_CELLS)))
    if step <= 1:
        return terrain.heights, terrain.resolution, terrain.origin
    rows, columns = (-(-cells // step) for cells in terrain.shape)
    padded = np.full((rows * step, columns * step), np.nan, np.float32)
    padded[: terrain.shape[0], : terrain.shape[1]] = terrain.heights
    blocks = padded.reshape(rows, step, columns, step)
    highest = np.where(is_ground(blocks), blocks, -np.inf).max(axis=(1, 3))
    shift = 0.5 * (step - 1) * terrain.resolution
    return (
        np.where(np.isneginf(highest), np.nan, highest),
        step * terrain.resolution,
        (terrain.origin[0] + shift, terrain.origin[1] + shift),
    )


def _tops(heights: np.ndarray, x: np.ndarray, y: np.ndarray, half: float) -> np.ndarray:
    ground = is_ground(heights)
    x, y, z = x[ground], y[ground], heights[ground]
    around = [(-half, -half), (half, -half), (half, half), (-half, half)]
    return np.stack([np.stack([x + dx, y + dy, z], axis=-1) for dx, dy in around], axis=1)


def _walls(heights: np.ndarray, x: np.ndarray, y: np.ndarray, half: float) -> np.ndarray:
    """Return the walls between each cell and the next one along its row."""
    here, there = heights[:, :-1], heights[:, 1:]
    step = np.abs(here - there) > 1e-4  # never true next to NaN
    edge, middle = x[:, :-1][step] + half, y[:, :-1][step]
    low, high = here[step], there[step]
    corners = [(-half, low), (half, low), (half, high), (-half, high)]
    return np.stack([np.stack([edge, middle + dy, z], axis=-1) for dy, z in corners], axis=1)


def meet(
    terrain: HeightMap,
    origin: Float[np.ndarray, " 3"],
    direction: Float[np.ndarray, " 3"],
    reach: float = 500.0,
) -> Float[np.ndarray, " 3"] | None:
    """Return where a ray first comes below the ground, or below the lowest ground over the void.

    Args:
        terrain: height map that the ray meets.
        origin: origin of the ray [m].
        direction: direction of the ray, of any length above 0.
        reach: length of the ray [m].

    Returns:
        The point [m], or None for a ray into the sky.
    """
    direction = np.asarray(direction, np.float64) / np.linalg.norm(direction)
    low, high = float(np.nanmin(terrain.heights)), float(np.nanmax(terrain.heights))
    if direction[2] > -1e-9:
        return None
    # The ray can meet the ground only between the highest and the lowest ground.
    first = max(0.0, (high - origin[2]) / direction[2])
    last = min(reach, (low - origin[2]) / direction[2])
    if last < first:
        return None
    step = 0.5 * terrain.resolution
    along = np.append(np.arange(first, last, step), last)
    points = np.asarray(origin)[None, :] + along[:, None] * direction[None, :]
    ground = np.nan_to_num(terrain.height_at(points[:, :2]), nan=low)
    below = np.flatnonzero(points[:, 2] <= ground + 1e-6)
    if not len(below):
        return None
    point = points[below[0]]
    return np.array([point[0], point[1], ground[below[0]]])
