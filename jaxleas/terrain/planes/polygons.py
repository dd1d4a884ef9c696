"""Regions of cells to convex polygons in their plane."""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Bool, Float

from jaxleas.terrain.height_map import HeightMap
from jaxleas.terrain.planes.connected import connected
from jaxleas.terrain.planes.convex_parts import area, convex_parts, distinct
from jaxleas.terrain.planes.outlines import outline
from jaxleas.terrain.planes.region import Region
from jaxleas.terrain.planes.rings import rings
from jaxleas.terrain.polygons import MIN_AREA

FILLED = 0.8
"""Part of an outline's area that its convex parts fill at least, unless it crosses itself."""
BEYOND = 4.0
"""Area by which they may be larger than the outline where it just touches itself [cells^2]."""


def polygons_of(
    region: Region, frame: HeightMap, inset: float, least: float
) -> list[Float[np.ndarray, "V 3"]]:
    """Return the convex parts of a region, drawn in from its edges.

    Args:
        region: cells and their plane.
        frame: map whose cells they are.
        inset: length by which edges are drawn in [m].
        least: area in plan below which a part is left out [m^2].
    """
    cells, rest = _drawn_in(region.cells, inset / frame.resolution)
    components, count = connected(cells)
    found = []
    for number in range(1, count + 1):
        around = rings(components == number)
        parts = parts_of([distinct(outline(ring, rest)) for ring in around])
        if parts is None:  # the outline of the cells never crosses itself
            parts = parts_of([ring.astype(np.float64) for ring in around]) or []
        found += parts
    enough = max(least, MIN_AREA) / frame.resolution**2
    return [_lifted(region, frame, part) for part in found if area(part) >= enough]


def _drawn_in(cells: Bool[np.ndarray, "R C"], inset: float) -> tuple[np.ndarray, float]:
    """Return cells without whole cells along their edges, and what is still to be drawn in."""
    from scipy.ndimage import distance_transform_edt

    whole = int(inset)
    if whole == 0:
        return cells, inset
    distance = distance_transform_edt(np.pad(cells, 1))
    assert isinstance(distance, np.ndarray)
    return distance[1:-1, 1:-1] > whole, inset - whole


def parts_of(outlines: Sequence[Float[np.ndarray, "V 2"]]) -> list[Float[np.ndarray, "W 2"]] | None:
    """Return the convex parts of an outline with holes; None if it crosses itself."""
    areas = [area(each) for each in outlines]
    outer = int(np.argmax(areas))
    if areas[outer] <= 0.0:
        return []
    holes = [each for each, its in zip(outlines, areas, strict=True) if its < 0.0]
    parts = convex_parts(outlines[outer], holes)
    whole = areas[outer] + sum(its for its in areas if its < 0.0)
    return parts if FILLED * whole <= sum(map(area, parts)) <= whole + BEYOND else None


def _lifted(
    region: Region, frame: HeightMap, corners: Float[np.ndarray, "V 2"]
) -> Float[np.ndarray, "V 3"]:
    """Return corners of cells in the region's box as points of its plane in the world [m]."""
    column, row = (corners + np.array([region.box[1].start, region.box[0].start]) - 0.5).T
    x, y = frame.origin[0] + column * frame.resolution, frame.origin[1] + row * frame.resolution
    return np.column_stack([x, y, region.plane.at(row, column)])
