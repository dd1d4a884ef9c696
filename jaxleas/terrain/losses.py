"""What a height map cannot hold of a terrain: things thinner than a cell, ground under others."""

import logging
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import cast

import numpy as np
from jaxtyping import Float

from jaxleas.terrain.areas import area_vectors, lengths
from jaxleas.terrain.cells import covered_cells
from jaxleas.terrain.height_map import HeightMap
from jaxleas.terrain.polygons import VERTICAL_SLOPE
from jaxleas.types import is_ground

_LOG = logging.getLogger("jaxleas")
THIN = 0.05
"""Height by which a corner exceeds the cells around it, from which on it counts as lost [m]."""
HEADROOM = 0.1
"""Height of free space under a face, from which on it counts as an overhang [m]."""
_DIAGONALLY = np.ones((3, 3))


@dataclass(frozen=True)
class Losses:
    """What a height map lacks.

    Attributes:
        thin: number of separate things that fall between the middles of cells.
        thin_height: height of the highest of them above the map around it [m].
        covered: area of ground that lies under something with free space between [m^2].
        headroom: largest height of that free space [m].
    """

    thin: int = 0
    thin_height: float = 0.0
    covered: float = 0.0
    headroom: float = 0.0


def losses(groups: Sequence[Float[np.ndarray, "N V 3"]], height_map: HeightMap) -> Losses:
    """Return what a map lacks of the polygons that it is made of.

    Args:
        groups: polygons (`padded_groups`); they look up where they are counter-clockwise seen
            from above [m].
        height_map: their height map.
    """
    thin, thin_height = _thin(np.concatenate([each.reshape(-1, 3) for each in groups]), height_map)
    covered, headroom = _covered(groups, height_map)
    return Losses(thin, thin_height, covered, headroom)


def say_losses(path: str | Path, found: Losses, resolution: float) -> None:
    """Say what a map lacks of a file, with numbers and sizes; nothing if it lacks nothing.

    Args:
        path: path of the file.
        found: what the map lacks.
        resolution: edge of the map's cells [m].
    """
    if found.thin:
        _LOG.warning(
            "%s: the map of %g m cells lacks %s thinner than a cell, up to %.2f m high; a finer"
            " --resolution may hold more",
            *(path, resolution, _things(found.thin), found.thin_height),
        )
    if found.covered > 0.0:
        _LOG.warning(
            "%s: %.2f m2 of ground lie under overhangs, with up to %.2f m of space between; a"
            " height map holds the upper face alone",
            *(path, found.covered, found.headroom),
        )


def _things(count: int) -> str:
    return "1 thing" if count == 1 else f"{count} things"


def _thin(points: Float[np.ndarray, "P 3"], height_map: HeightMap) -> tuple[int, float]:
    """Return number and height of the places where corners lie above all cells around them."""
    from scipy.ndimage import label, maximum_filter

    ground = np.where(is_ground(height_map.heights), height_map.heights, -np.inf)
    around = maximum_filter(ground, size=3)
    row, column, inside = _cells(points, height_map)
    above = np.where(inside, points[:, 2] - around[row, column], -np.inf)
    lost = above > THIN
    if not lost.any():
        return 0, 0.0
    marked = np.zeros(ground.shape, bool)
    marked[row[lost], column[lost]] = True
    # What lies over the void has no ground around it to be measured from.
    height = above[lost & np.isfinite(above)].max(initial=THIN)
    marked = maximum_filter(marked, size=3)
    _, count = cast(tuple[np.ndarray, int], label(marked, _DIAGONALLY))
    return count, float(height)


def _covered(
    groups: Sequence[Float[np.ndarray, "N V 3"]], height_map: HeightMap
) -> tuple[float, float]:
    """Return area and height of free space between faces that look up and down over them."""
    upward = [_upward(each) for each in groups]
    pairs = list(zip(groups, upward, strict=True))
    down, up = ([each[sign * its > VERTICAL_SLOPE] for each, its in pairs] for sign in (-1.0, 1.0))
    if not (any(map(len, down)) and any(map(len, up))):
        return 0.0, 0.0
    ceiling = np.full(height_map.heights.size, -np.inf)
    ground = np.full(height_map.heights.size, -np.inf)
    for cell, z in covered_cells(down, height_map):
        np.maximum.at(ceiling, cell, z)
    for cell, z in covered_cells(up, height_map):
        lower = z < ceiling[cell] - HEADROOM
        np.maximum.at(ground, cell[lower], z[lower])
    # Inside a body more faces above look up than down.
    ground[np.isneginf(ground)] = np.nan
    middle = 0.5 * (ceiling + ground)
    within = np.zeros(height_map.heights.size, np.int32)
    for faces, sign in ((up, 1), (down, -1)):
        for cell, z in covered_cells(faces, height_map):
            np.add.at(within, cell[z > middle[cell]], sign)
    free = np.isfinite(middle) & (within <= 0)
    if not free.any():
        return 0.0, 0.0
    space = (ceiling - ground)[free].max()
    return float(free.sum()) * height_map.resolution**2, float(space)


def _upward(polygons: Float[np.ndarray, "N V 3"]) -> Float[np.ndarray, " N"]:
    """Return the upward parts of unit normals."""
    area = area_vectors(polygons)
    return area[:, 2] / np.maximum(lengths(area), 1e-300)


def _cells(
    points: Float[np.ndarray, "P 3"], height_map: HeightMap
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    cells = np.floor((points[:, :2] - height_map.origin) / height_map.resolution + 0.5)
    column, row = cells.astype(np.int64).T
    rows, columns = height_map.shape
    inside = (row >= 0) & (row < rows) & (column >= 0) & (column < columns)
    return np.where(inside, row, 0), np.where(inside, column, 0), inside
