"""Polygons as people write them: rings closed by their first vertex, clockwise, a little off plane.

Where the meaning is plain, it is done and said.
"""

import logging
from collections.abc import Mapping
from pathlib import Path

import numpy as np
from jaxtyping import Float

from jaxleas.terrain.polygons import (
    MIN_AREA,
    PLANARITY_TOLERANCE,
    VERTICAL_SLOPE,
    polygon_area_vector,
    upwardness,
)

_LOG = logging.getLogger("jaxleas")
SAME = 1e-6
"""Distance below which two vertices are the same [m]."""
FLATTENED = 0.005
"""Largest distance of a vertex from its polygon's plane that is mended [m]."""
LEVEL = 0.866
"""Cosine of the slope, 30 degrees, up to which a clockwise surface may be a floor."""
Vertices = Float[np.ndarray, "V D"]


def without_repeats(vertices: Vertices) -> Vertices:
    """Return a ring without vertices that repeat the one before, the first one at the end too."""
    if len(vertices) < 2:
        return vertices
    ahead = np.linalg.norm(vertices - np.roll(vertices, 1, axis=0), axis=1)
    kept = ahead >= SAME
    if kept.sum() == len(vertices) or kept.sum() < 3:
        return vertices
    if not kept[0]:  # the last vertex closes the ring: it goes, not the first
        kept[0], kept[-1] = True, False
    return vertices[kept]


def flattened(path: str | Path, name: str, vertices: Float[np.ndarray, "V 3"]) -> Vertices:
    """Return a polygon moved into its plane, if that is a matter of millimetres; it is said."""
    if len(vertices) < 4 or not np.isfinite(vertices).all():
        return vertices
    area = polygon_area_vector(vertices)
    if np.linalg.norm(area) < MIN_AREA:
        return vertices
    normal = area / np.linalg.norm(area)
    off = (vertices - vertices.mean(axis=0)) @ normal
    deviation = float(np.abs(off).max())
    if not PLANARITY_TOLERANCE < deviation <= FLATTENED:
        return vertices
    _LOG.warning(
        "%s: a vertex of '%s' lies %.1f mm off its plane: moved into it",
        *(path, name, 1000.0 * deviation),
    )
    return vertices - np.outer(off, normal)


def turned_up(
    path: str | Path, surfaces: dict[str, Vertices], touch: Mapping[str, str]
) -> dict[str, Vertices]:
    """Return surfaces with the floors among them that are clockwise seen from above turned.

    A surface that looks down is a ceiling if something to stand on lies below it, or if `touch`
    says who may touch it. Otherwise, if it is about level, it is a floor: nobody can be under it.

    Args:
        path: path of the scene, for messages.
        surfaces: polygons by name [m].
        touch: kind of effector that may touch a surface, by its name.
    """
    proper = {name: each for name, each in surfaces.items() if _has_area(each)}
    upward = {name: upwardness(each) for name, each in proper.items()}
    floors = [each for name, each in proper.items() if upward[name] > VERTICAL_SLOPE]
    clockwise = [
        name
        for name, each in proper.items()
        if upward[name] < -LEVEL and name not in touch and not _lies_over_any(each, floors)
    ]
    _say_turned(path, "surface", clockwise)
    return {name: each[::-1] if name in clockwise else each for name, each in surfaces.items()}


def counter_clockwise(
    path: str | Path, kind: str, polygons: dict[str, Vertices]
) -> dict[str, Vertices]:
    """Return polygons with those turned that are clockwise seen from above, which is said."""
    clockwise = [
        name
        for name, each in polygons.items()
        if _has_area(_lifted(each)) and upwardness(_lifted(each)) < -VERTICAL_SLOPE
    ]
    _say_turned(path, kind, clockwise)
    return {name: each[::-1] if name in clockwise else each for name, each in polygons.items()}


def _say_turned(path: str | Path, kind: str, names: list[str]) -> None:
    if names:
        more = f" and {len(names) - 1} more" if len(names) > 1 else ""
        _LOG.warning(
            "%s: %s '%s'%s is clockwise seen from above: turned", path, kind, names[0], more
        )


def _lies_over_any(vertices: Vertices, floors: list[Vertices]) -> bool:
    """Tell whether the bounding box of a polygon lies over one of the floors, and higher."""
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    return any(
        (floor[:, :2].min(axis=0) < high[:2]).all()
        and (floor[:, :2].max(axis=0) > low[:2]).all()
        and floor[:, 2].min() < high[2]
        for floor in floors
    )


def _lifted(vertices: Vertices) -> Float[np.ndarray, "V 3"]:
    if vertices.shape[1] == 3:
        return vertices
    return np.column_stack([vertices[:, :2], np.zeros(len(vertices))])


def _has_area(vertices: Vertices) -> bool:
    return len(vertices) >= 3 and bool(np.linalg.norm(polygon_area_vector(vertices)) >= MIN_AREA)
