"""Height maps as one closed body, which simulators need."""

from pathlib import Path

import numpy as np
from jaxtyping import Bool, Float, Int

from jaxleas.terrain.height_map import HeightMap
from jaxleas.types import InputError, is_ground

THICKNESS = 0.2
"""Depth of the body below the lowest ground [m]."""


def map_body(height_map: HeightMap, where: str | Path) -> Float[np.ndarray, "N 3 3"]:
    """Return a closed body whose upper face passes through the middles of the cells.

    That is what simulators make of height fields. The body ends at the middles of the outermost
    cells; a cell of ground without neighbours in two directions is lost.

    Args:
        height_map: heights of the cells.
        where: name of the file, for the message.

    Raises:
        InputError: there are no such neighbours anywhere.
    """
    rows, columns = height_map.shape
    x = height_map.origin[0] + height_map.resolution * np.arange(columns)
    y = height_map.origin[1] + height_map.resolution * np.arange(rows)
    ground = is_ground(height_map.heights)
    z = np.where(ground, height_map.heights, 0.0).astype(np.float64)
    points = np.stack([*np.meshgrid(x, y), z], axis=-1).reshape(-1, 3)
    faces = faces_between(ground)
    if not len(faces):
        raise InputError(
            f"{where}: no three cells of ground of the map meet at a corner: it makes no body"
        )
    base = points.copy()
    base[:, 2] = z[ground].min() - THICKNESS
    start, end = _rim(faces).T
    sides = [
        np.stack([points[start], base[start], base[end]], axis=1),
        np.stack([points[start], base[end], points[end]], axis=1),
    ]
    return np.concatenate([points[faces], base[faces[:, ::-1]], *sides])


def faces_between(ground: Bool[np.ndarray, "R C"]) -> Int[np.ndarray, "N 3"]:
    """Return triangles between the middles of cells of ground: two for four cells, one for three.

    Args:
        ground: which cells are ground.
    """
    index = np.arange(ground.size).reshape(ground.shape)
    corners = index[:-1, :-1], index[:-1, 1:], index[1:, 1:], index[1:, :-1]
    square = np.stack(corners, axis=-1).reshape(-1, 4)  # counter-clockwise
    known = ground.reshape(-1)[square]
    whole = square[known.all(axis=1)]
    three = known.sum(axis=1) == 3
    rest = square[three][known[three]].reshape(-1, 3)
    return np.concatenate([whole[:, :3], whole[:, [0, 2, 3]], rest])


def _rim(faces: Int[np.ndarray, "N 3"]) -> Int[np.ndarray, "E 2"]:
    """Return the edges that one triangle alone has, in its direction."""
    edges = np.stack([faces, np.roll(faces, -1, axis=1)], axis=-1).reshape(-1, 2)
    _, number, count = np.unique(
        np.sort(edges, axis=1), axis=0, return_inverse=True, return_counts=True
    )
    return edges[count[number.reshape(-1)] == 1]
