"""Vertical faces in a height map: what no cell centre lies under is drawn by its upper edge."""

from collections.abc import Iterator, Sequence

import numpy as np
from jaxtyping import Bool, Float, Int

from jaxleas.terrain.areas import are_level, area_vectors

HELD = 5e-3
"""Height by which an upper edge may exceed the cells around it and still count as held [m]."""
BESIDE = (-1.0, -0.5, 0.5, 1.0)
"""Distances from an edge, to either side, at which a body is looked for [cells]."""
CORNER = 2.0
"""Distance from the ends of an edge within which cells on all sides count [cells]: at the corner of
a body those beside the edge may lie outside."""
WELD = 1e-5
"""Distance below which ends of edges are the same point [m]."""
_POLYGONS = 200_000  # at a time, to save memory
_CROSSINGS = 2_000_000  # of edges and sides of cells at a time, to save memory


def raise_sheets(
    heights: Float[np.ndarray, "R C"],
    polygons: Sequence[Float[np.ndarray, "N V 3"]],
    origin: Float[np.ndarray, " 2"],
    resolution: float,
) -> Bool[np.ndarray, "R C"]:
    """Raise cells to the upper edges of vertical faces which the map does not hold.

    The side of a body is held by the body's top, in the cells next to it on one side; then nothing
    changes. A wall without thickness, and one that falls between two cell centres, becomes one
    cell wide.

    Args:
        heights: heights of the cells [m], -inf where there is no ground; changed in place.
        polygons: all polygons, in groups; those that are not vertical have been drawn [m].
        origin: middle of cell (0, 0) [m].
        resolution: edge of a cell [m].

    Returns:
        Which cells were raised.
    """
    raised = np.zeros(heights.shape, bool)
    level = [are_level(area_vectors(each)) for each in polygons]
    groups = list(zip(polygons, level, strict=True))
    ends = np.concatenate([_edges(each[~its]) for each, its in groups])
    if not len(ends):
        return raised
    found = list(_above(ends, heights, origin, resolution))
    if not found:
        return raised
    cell, z, held, edge = (np.concatenate(each) for each in zip(*found, strict=True))
    # An edge that carries a top is the side of a body: its top may slope away within a cell.
    used = np.unique(edge)
    keys = _keys(ends[used])
    carries = np.any([_are_among(keys, each[its]) for each, its in groups], axis=0)
    slack = np.where(carries, 2.0 * resolution, HELD)[np.searchsorted(used, edge)]
    high = z > held + slack
    np.maximum.at(heights.reshape(-1), cell[high], z[high].astype(heights.dtype))
    raised.reshape(-1)[cell[high]] = True
    return raised


def _edges(polygons: Float[np.ndarray, "N V 3"]) -> Float[np.ndarray, "E 2 3"]:
    ends = np.stack([polygons, np.roll(polygons, -1, axis=1)], axis=2).reshape(-1, 2, 3)
    return ends[np.linalg.norm(ends[:, 1, :2] - ends[:, 0, :2], axis=1) > WELD]


def _are_among(
    keys: Int[np.ndarray, " E"], polygons: Float[np.ndarray, "N V 3"]
) -> Bool[np.ndarray, " E"]:
    """Return which keys are those of edges of polygons, which may be very many more."""
    ordered, index = np.unique(keys, return_inverse=True)
    found = np.zeros(len(ordered), bool)
    for start in range(0, len(polygons), _POLYGONS):
        theirs = _keys(_edges(polygons[start : start + _POLYGONS]))
        at = np.minimum(np.searchsorted(ordered, theirs), len(ordered) - 1)
        found[at[ordered[at] == theirs]] = True
    return found[index]


def _above(
    ends: Float[np.ndarray, "E 2 3"],
    heights: Float[np.ndarray, "R C"],
    origin: np.ndarray,
    resolution: float,
) -> Iterator[tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]]:
    """Yield the cells that edges pass above the cells beside them, with numbers for each.

    These are the height of the edge there, that of the cells beside it, and which edge it is.
    """
    cells = (ends[..., :2] - origin) / resolution + 0.5  # cell k spans k to k + 1
    from scipy.ndimage import maximum_filter  # here, so that the viewer shows ground without it

    around = maximum_filter(heights, size=3)
    first, last = np.ceil(cells.min(axis=1)), np.floor(cells.max(axis=1))
    count = np.maximum(last - first + 1, 0).astype(np.int64)  # sides of cells that an edge crosses
    batch = np.cumsum(count.sum(axis=1) + 2) // _CROSSINGS
    for each in np.unique(batch):
        members = np.flatnonzero(batch == each)
        edge, along = _crossings(members, cells, first, count)
        same = edge[1:] == edge[:-1]
        edge, start, end = edge[:-1][same], along[:-1][same], along[1:][same]
        middle = (0.5 * (start + end))[:, None]
        place = cells[edge, 0] + middle * (cells[edge, 1] - cells[edge, 0])
        z, rise = ends[edge, 0, 2], ends[edge, 1, 2] - ends[edge, 0, 2]
        highest = np.maximum(z + start * rise, z + end * rise)
        cell = _cells(place, heights.shape)
        along = cells[edge, 1] - cells[edge, 0]
        length = np.linalg.norm(along, axis=1, keepdims=True)
        beside = along[:, ::-1] * [-1.0, 1.0] / length
        held = heights.reshape(-1)[cell]
        for distance in BESIDE:
            near = _cells(place + distance * beside, heights.shape)
            held = np.maximum(held, heights.reshape(-1)[near])
        at_corner = (np.minimum(middle, 1.0 - middle) * length)[:, 0] < CORNER
        held = np.where(at_corner, around.reshape(-1)[cell], held)
        above = highest > held + HELD
        if above.any():
            yield cell[above], highest[above], held[above], edge[above]


def _cells(places: Float[np.ndarray, "S 2"], shape: tuple[int, ...]) -> Int[np.ndarray, " S"]:
    """Return the flat indices of cells; a map has a margin, and what lies outside is nearest."""
    column, row = np.floor(places).astype(np.int64).T
    return np.clip(row, 0, shape[0] - 1) * shape[1] + np.clip(column, 0, shape[1] - 1)


def _crossings(
    members: Int[np.ndarray, " M"],
    cells: Float[np.ndarray, "E 2 2"],
    first: Float[np.ndarray, "E 2"],
    count: Int[np.ndarray, "E 2"],
) -> tuple[Int[np.ndarray, " S"], Float[np.ndarray, " S"]]:
    """Return where edges begin, cross sides of cells, and end: the edge and 0 to 1, in order."""
    edges = [members, members]
    places = [np.zeros(len(members)), np.ones(len(members))]
    for axis in range(2):
        number = count[members, axis]
        edge = np.repeat(members, number)
        step = np.arange(len(edge)) - np.repeat(np.cumsum(number) - number, number)
        begin, end = cells[edge, 0, axis], cells[edge, 1, axis]
        length = np.where(end == begin, 1.0, end - begin)
        edges.append(edge)
        places.append(np.clip((first[edge, axis] + step - begin) / length, 0.0, 1.0))
    edge, along = np.concatenate(edges), np.concatenate(places)
    order = np.lexsort((along, edge))
    return edge[order], along[order]


def _keys(ends: Float[np.ndarray, "E 2 3"]) -> Int[np.ndarray, " E"]:
    """Return a number for each edge, the same from either end."""
    with np.errstate(over="ignore"):
        points = np.round(ends / WELD).astype(np.int64) * np.array([1, 2_654_435_761, 40_503_001])
        mixed = points.sum(axis=-1)
        mixed = (mixed ^ (mixed >> 29)) * -4_658_895_280_553_007_687
        return mixed[:, 0] + mixed[:, 1]
