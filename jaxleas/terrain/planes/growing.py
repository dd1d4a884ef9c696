"""Region growing: from the flattest windows to cores of planes, the largest windows first.

A large window averages noise away and proves a plane beyond doubt, but covers no narrow tread;
so what large windows leave is left to smaller ones. Cores stay half a window away from edges;
`assigning.py` brings each cell up to the edge to its plane.
"""

import numpy as np
from jaxtyping import Bool

from jaxleas.terrain.planes.connected import connected
from jaxleas.terrain.planes.plane import Box, Plane, around, fitted
from jaxleas.terrain.planes.region import Growth, Region
from jaxleas.terrain.planes.seeds import flattest_first, large
from jaxleas.terrain.planes.windows import Windows

CERTAIN = 3.0
"""Standard deviations within which a fitted number may differ from its expectation."""
BEND = 0.01
"""Slope by which windows of one plane may differ without any noise."""
RISE = 0.1
"""Height by which they may differ, besides that of their noise, in its standard deviations."""
FIRST_REACH = 2
"""Half side of the first part of the map in which a plane grows, in windows."""


def grow_regions(ground: Growth, scales: list[Windows]) -> list[Region]:
    """Return the cores of all planes, largest windows first.

    Args:
        ground: what regions grow on.
        scales: windows of all sizes, the largest first.
    """
    regions: list[Region] = []
    taken = np.zeros(ground.known.shape, bool)
    for windows in scales:
        usable = ground.known & flat_windows(windows, ground.noise)
        regions = [_extended(ground, windows, usable & ~taken, each) for each in regions]
        taken[:] = False
        for each in regions:
            taken[each.box] |= each.cells
        regions += _fresh(ground, windows, usable & ~taken)
    return regions


def flat_windows(windows: Windows, noise: float) -> Bool[np.ndarray, "R C"]:
    """Return which windows differ from a plane by no more than noise would make them."""
    most = noise * (1.0 + CERTAIN / np.sqrt(2.0 * windows.freedom))
    return windows.deviation <= most  # a NaN is not


def _fresh(
    ground: Growth,
    windows: Windows,
    usable: Bool[np.ndarray, "R C"],
) -> list[Region]:
    """Return new regions, from the flattest windows on; they are taken out of `usable`."""
    found = []
    seeds = large(usable, ground.least_core)
    for seed in flattest_first(seeds, windows):
        first, region = _grown(ground, windows, usable, seed)
        if region is None:
            seeds[around(_box_of(seed), windows.size // 2, seeds.shape)] = False
            seeds[first.box] &= ~first.cells  # they would begin with the same plane
            continue
        found.append(region)
        for each in (usable, seeds):
            each[region.box] &= ~region.cells
    return found


def _grown(
    ground: Growth, windows: Windows, usable: Bool[np.ndarray, "R C"], seed: tuple[int, int]
) -> tuple[Region, Region | None]:
    """Return the connected windows around a seed that agree with its plane.

    Returns:
        Those near it that agree with the plane of its own window; and the whole region, None if it
        comes to too little.
    """
    r, c = seed
    slopes = float(windows.along_rows[r, c]), float(windows.along_columns[r, c])
    plane = Plane(float(windows.height[r, c]) - slopes[0] * r - slopes[1] * c, *slopes)
    reach = FIRST_REACH * windows.size
    box = around(_box_of(seed), reach, usable.shape)
    first, settled = None, False
    while True:
        cells = _agreeing(ground, windows, usable, plane, box)
        if np.count_nonzero(cells) >= ground.least_core:  # whether they hang together or not
            cells = _with(cells, (r - box[0].start, c - box[1].start))
        region = Region(plane, box, cells)
        first = first or region
        if np.count_nonzero(cells) < ground.least_core:
            return first, None
        plane = fitted(ground.heights[box], cells, box)
        wider = _wider(box, cells, reach, usable.shape)
        if settled and wider == box:
            return first, Region(plane, box, cells).trimmed()
        settled = wider == box
        box, reach = wider, 2 * reach


def _box_of(cell: tuple[int, int]) -> Box:
    row, column = cell
    return slice(row, row + 1), slice(column, column + 1)


def _extended(
    ground: Growth, windows: Windows, usable: Bool[np.ndarray, "R C"], region: Region
) -> Region:
    """Return a region with the windows of a smaller size that agree with it and touch it."""
    box = around(region.box, 2 * windows.size, usable.shape)
    before = region.within(box)
    agree = _agreeing(ground, windows, usable, region.plane, box) | before
    components, count = connected(agree)
    kept = np.zeros(count + 1, bool)
    kept[components[before]] = True
    cells = kept[components]
    return Region(fitted(ground.heights[box], cells, box), box, cells).trimmed()


def _agreeing(
    ground: Growth, windows: Windows, usable: Bool[np.ndarray, "R C"], plane: Plane, box: Box
) -> Bool[np.ndarray, "r c"]:
    """Return which windows in a part of the map lie on a plane and have its slope."""
    bend = BEND * ground.resolution + CERTAIN * ground.noise * windows.slope_share
    rise = ground.noise * (RISE + CERTAIN / windows.size)
    agree = np.abs(windows.height[box] - plane.over(box)) <= rise
    agree &= usable[box]
    agree &= np.abs(windows.along_rows[box] - plane.along_rows) <= bend
    agree &= np.abs(windows.along_columns[box] - plane.along_columns) <= bend
    return agree


def _with(cells: Bool[np.ndarray, "r c"], seed: tuple[int, int]) -> Bool[np.ndarray, "r c"]:
    """Return the connected cells that a seed is one of; none if it is not."""
    if not cells[seed]:
        return np.zeros_like(cells)
    components, _ = connected(cells)
    return components == components[seed]


def _wider(box: Box, cells: Bool[np.ndarray, "r c"], reach: int, shape: tuple[int, int]) -> Box:
    """Return a part of a map with more cells on the sides that a region touches."""
    sides = []
    for axis, side in enumerate(box):
        first, last = (bool(cells.take(at, axis).any()) for at in (0, -1))
        low = max(side.start - reach * first, 0)
        sides.append(slice(low, min(side.stop + reach * last, shape[axis])))
    return sides[0], sides[1]
