"""Regions taken apart where they do not hang together, their small holes closed."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from jaxtyping import Int

from jaxleas.terrain.planes.connected import connected
from jaxleas.terrain.planes.plane import inner
from jaxleas.terrain.planes.region import Growth, Region

STANDS_OUT = 5.0
"""Standard deviations from which on a cell's distance from a plane is no noise."""
WIDE = 100
"""Number of windows whose area is proof enough that a region is not narrow everywhere."""


def is_wide(region: Region, least: int, width: int) -> bool:
    """Return whether a region has enough cells, and room for a disc somewhere.

    Args:
        region: cells of a plane.
        least: number of cells that are enough.
        width: number of cells along the diameter of the disc.
    """
    from scipy.ndimage import distance_transform_edt

    if region.size < least:
        return False
    if region.size > WIDE * width**2:
        return True
    depth = distance_transform_edt(np.pad(region.cells, 1))
    assert isinstance(depth, np.ndarray)
    return bool(depth.max() >= 0.5 * width)


def pieces(regions: Sequence[Region]) -> list[Region]:
    """Return regions whose cells hang together by their sides."""
    from scipy.ndimage import find_objects

    found = []
    for region in regions:
        components, _ = connected(region.cells)
        for number, part in enumerate(find_objects(components), start=1):
            box = inner(region.box, part)
            found.append(Region(region.plane, box, components[part] == number))
    return found


def closed(ground: Growth, region: Region, owner: Int[np.ndarray, "R C"], widest: int) -> Region:
    """Return a region with its holes up to a width, unless something stands in them.

    Args:
        ground: heights and noise.
        region: cells that hang together.
        owner: number of the region of each cell of the map; 0 for none.
        widest: largest number of cells along the side of a hole.
    """
    from scipy.ndimage import find_objects

    if widest == 0:
        return region
    outside, _ = connected(~np.pad(region.cells, 1))
    holes, beyond = outside[1:-1, 1:-1], outside[0, 0]
    cells = region.cells.copy()
    for number, part in enumerate(find_objects(holes), start=1):
        if part is None or number == beyond:
            continue
        hole, box = holes[part] == number, inner(region.box, part)
        gap = np.abs(ground.heights[box] - region.plane.over(box)) / ground.noise
        stands = (owner[box] > 0) | (ground.known[box] & (gap > STANDS_OUT))
        if max(hole.shape) <= widest and not stands[hole].any():
            cells[part] |= hole
    return replace(region, cells=cells)
