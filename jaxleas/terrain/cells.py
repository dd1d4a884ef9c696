"""The cells of a map whose middles lie under polygons, many polygons at a time."""

from collections.abc import Iterator, Sequence
from functools import reduce
from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float, Int

from jaxleas.terrain.areas import are_level
from jaxleas.terrain.height_map import HeightMap

BLOCK = 64
"""Largest side of the blocks into which polygons are cut, to save memory [cells]."""
BATCH_CELLS, BATCH_POLYGONS, BATCH_CORNERS = 1_000_000, 200_000, 4_000_000


def padded_groups(
    polygons: Sequence[np.ndarray] | np.ndarray,
) -> list[Float[np.ndarray, "N V 3"]]:
    """Return padded polygons; of very many, those of about as many corners together.

    One polygon of a thousand corners among a hundred thousand of four would fill the memory.
    """
    if isinstance(polygons, np.ndarray):
        return [padded_polygons(polygons)]
    count = np.array([len(vertices) for vertices in polygons])
    if count.max() * len(count) <= BATCH_CORNERS:
        return [padded_polygons(polygons)]
    size = np.ceil(np.log2(count))
    members = [np.flatnonzero(size == each).tolist() for each in np.unique(size)]
    return [padded_polygons([polygons[index] for index in each]) for each in members]


def padded_polygons(
    polygons: Sequence[np.ndarray] | np.ndarray,
) -> Float[np.ndarray, "N V 3"]:
    """Repeat last vertices until all polygons have as many; an edge of length 0 has no effect."""
    if isinstance(polygons, np.ndarray):
        return polygons.astype(np.float64, copy=False)
    lengths = np.array([len(vertices) for vertices in polygons])
    last = np.minimum(np.arange(lengths.max()), lengths[:, None] - 1)
    corners = np.concatenate(polygons).astype(np.float64, copy=False)
    return corners[(np.cumsum(lengths) - lengths)[:, None] + last]


def covered_cells(
    groups: Sequence[Float[np.ndarray, "N V 3"]], frame: HeightMap, grow: float = 0.0
) -> Iterator[tuple[Int[np.ndarray, " K"], Float[np.ndarray, " K"]]]:
    """Yield flat indices of cells whose middles lie under a polygon, and its heights there [m].

    Args:
        groups: convex polygons (`padded_groups`), vertical ones among them are left out [m].
        frame: a map with the cells; its heights do not matter.
        grow: length by which the sides are moved outwards [m].
    """
    rows, columns = frame.shape
    batches = (
        each[start : start + BATCH_POLYGONS]
        for each in groups
        for start in range(0, len(each), BATCH_POLYGONS)
    )
    for some in batches:
        some = some[_may_cover(some, frame, grow)]
        planes = _planes(some, np.array(frame.origin), frame.resolution, grow)
        for size, chosen, corner in _batches(planes, rows, columns):
            yield _under(rows, columns, planes, size, chosen, corner)


def _may_cover(
    polygons: Float[np.ndarray, "N V 3"], frame: HeightMap, grow: float
) -> Bool[np.ndarray, " N"]:
    """Return which polygons may lie over the middle of a cell: of many small ones few do."""
    found = np.ones(len(polygons), bool)
    reach = (grow + 2e-6 * frame.resolution) / frame.resolution
    for axis in range(2):
        corners = [polygons[:, corner, axis] for corner in range(polygons.shape[1])]
        low, high = (
            (reduce(pick, corners) - frame.origin[axis]) / frame.resolution
            for pick in (np.minimum, np.maximum)
        )
        found &= np.ceil(low - reach) <= np.floor(high + reach)
    return found


class _Planes(NamedTuple):
    """Non-vertical polygons in cell units: inside where normal . cell <= offset for all edges."""

    normal: Float[np.ndarray, "N V 2"]
    offset: Float[np.ndarray, "N V"]
    slope: Float[np.ndarray, "N 2"]
    height: Float[np.ndarray, " N"]
    first: Int[np.ndarray, "N 2"]
    last: Int[np.ndarray, "N 2"]


def _planes(
    polygons: Float[np.ndarray, "N V 3"], origin: np.ndarray, resolution: float, grow: float
) -> _Planes:
    following = np.roll(polygons, -1, axis=1)
    centre = polygons.mean(axis=1, keepdims=True)
    # Not `area_vectors`, which differs in the last bits: so would slopes, and maps made before.
    area = 0.5 * np.cross(polygons - centre, following - centre).sum(axis=1)
    level = are_level(area)
    polygons, following, area = polygons[level], following[level], area[level]
    cells = (polygons[..., :2] - origin) / resolution
    corners = [cells[:, corner] for corner in range(cells.shape[1])]
    edge = (following[..., :2] - polygons[..., :2]) * np.sign(area[:, 2])[:, None, None]
    length = np.linalg.norm(edge, axis=-1, keepdims=True)
    outward = np.stack([edge[..., 1], -edge[..., 0]], axis=-1)
    normal = np.divide(outward, length, out=np.zeros_like(outward), where=length > 0.0)
    slope = -area[:, :2] / area[:, 2:] * resolution
    anchor = polygons.mean(axis=1)
    anchor_cell = (anchor[:, :2] - origin) / resolution
    # 1e-6 cells, so that rounding leaves no cell between neighbours that share an edge
    reach = grow / resolution + 1e-6
    return _Planes(
        normal=normal,
        offset=(normal * cells).sum(axis=-1) + reach,
        slope=slope,
        height=anchor[:, 2] - (slope * anchor_cell).sum(axis=-1),
        first=np.ceil(reduce(np.minimum, corners) - reach).astype(np.int64),
        last=np.floor(reduce(np.maximum, corners) + reach).astype(np.int64),
    )


def _batches(
    planes: _Planes, rows: int, columns: int
) -> Iterator[tuple[int, Int[np.ndarray, " B"], Int[np.ndarray, "B 2"]]]:
    """Yield (block size, polygon indices, first cells) of blocks that cover every polygon."""
    first = np.maximum(planes.first, 0)
    last = np.minimum(planes.last, np.array([columns, rows]) - 1)
    span = last - first + 1
    count = np.where((span > 0).all(axis=1, keepdims=True), -(-span // BLOCK), 0)
    blocks = count[:, 0] * count[:, 1]
    polygon = np.repeat(np.arange(len(blocks)), blocks)
    within = np.arange(len(polygon)) - np.repeat(np.cumsum(blocks) - blocks, blocks)
    across = np.maximum(count[polygon, 0], 1)
    corner = first[polygon] + BLOCK * np.stack([within % across, within // across], axis=-1)
    needed = np.minimum(last[polygon] - corner + 1, BLOCK).max(axis=1, initial=1)
    size = 2 ** np.ceil(np.log2(needed)).astype(np.int64)
    for side in np.unique(size):
        members = np.flatnonzero(size == side)
        step = max(1, BATCH_CELLS // int(side * side))
        for start in range(0, len(members), step):
            chosen = members[start : start + step]
            yield int(side), polygon[chosen], corner[chosen]


def _under(
    rows: int,
    columns: int,
    planes: _Planes,
    side: int,
    chosen: Int[np.ndarray, " B"],
    corner: Int[np.ndarray, "B 2"],
) -> tuple[Int[np.ndarray, " K"], Float[np.ndarray, " K"]]:
    """Return the cells in these blocks that the polygons cover, and the heights there."""
    step = np.arange(side)
    x = (corner[:, 0, None] + step)[:, None, :]
    y = (corner[:, 1, None] + step)[:, :, None]
    last = planes.last[chosen]
    inside = (x <= np.minimum(last[:, 0], columns - 1)[:, None, None]) & (
        y <= np.minimum(last[:, 1], rows - 1)[:, None, None]
    )
    for edge in range(planes.normal.shape[1]):
        normal = planes.normal[chosen, edge, :, None, None]
        inside &= normal[:, 0] * x + normal[:, 1] * y <= planes.offset[chosen, edge, None, None]
    slope = planes.slope[chosen, :, None, None]
    z = slope[:, 0] * x + slope[:, 1] * y + planes.height[chosen, None, None]
    return (y * columns + x)[inside], z[inside]
