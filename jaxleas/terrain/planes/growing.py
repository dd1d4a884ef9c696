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
    seeds = _large(usable, ground.least_core)
    row, column = np.nonzero(seeds)
    order = np.argsort(windows.deviation[row, column], kind="stable")
    half = windows.size // 2
    for r, c in zip(row[order].tolist(), column[order].tolist(), strict=True):
        if not seeds[r, c]:
            continue
        region = _grown(ground, windows, usable, (r, c))
        if region.size < ground.least_core:
            seeds[max(r - half, 0) : r + half + 1, max(c - half, 0) : c + half + 1] = False
            continue
        found.append(region)
        for each in (usable, seeds):
            each[region.box] &= ~region.cells
    return found


def _grown(
    ground: Growth, windows: Windows, usable: Bool[np.ndarray, "R C"], seed: tuple[int, int]
) -> Region:
    """Return the connected windows around a seed that agree with its plane."""
    r, c = seed
    slopes = float(windows.along_rows[r, c]), float(windows.along_columns[r, c])
    plane = Plane(float(windows.height[r, c]) - slopes[0] * r - slopes[1] * c, *slopes)
    reach = FIRST_REACH * windows.size
    box = around((slice(r, r + 1), slice(c, c + 1)), reach, usable.shape)
    region = Region(plane, box, np.zeros((0, 0), bool))
    while True:
        for _ in range(2):
            cells = _agreeing(ground, windows, usable, region.plane, box)
            if np.count_nonzero(cells) < ground.least_core:  # whether they hang together or not
                return Region(plane, box, cells)
            cells = _with(cells, (r - box[0].start, c - box[1].start))
            if cells.sum() < ground.least_core:
                return Region(plane, box, cells)
            region = Region(fitted(ground.heights[box], cells, box), box, cells)
        wider = around(box, reach, usable.shape)
        if wider == box or not _touches_rim(region.cells):
            return region
        box, reach = wider, 2 * reach


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
    return Region(fitted(ground.heights[box], cells, box), box, cells)


def _agreeing(
    ground: Growth, windows: Windows, usable: Bool[np.ndarray, "R C"], plane: Plane, box: Box
) -> Bool[np.ndarray, "r c"]:
    """Return which windows in a part of the map lie on a plane and have its slope."""
    bend = BEND * ground.resolution + CERTAIN * ground.noise * windows.slope_share
    rise = ground.noise * (RISE + CERTAIN / windows.size)
    agree = usable[box] & (np.abs(windows.height[box] - plane.over(box)) <= rise)
    agree &= np.abs(windows.along_rows[box] - plane.along_rows) <= bend
    return agree & (np.abs(windows.along_columns[box] - plane.along_columns) <= bend)


def _with(cells: Bool[np.ndarray, "r c"], seed: tuple[int, int]) -> Bool[np.ndarray, "r c"]:
    """Return the connected cells that a seed is one of; none if it is not."""
    if not cells[seed]:
        return np.zeros_like(cells)
    components, _ = connected(cells)
    return components == components[seed]


def _large(cells: Bool[np.ndarray, "R C"], least: int) -> Bool[np.ndarray, "R C"]:
    """Return the cells that hang together with enough others."""
    components, _ = connected(cells)
    enough = np.bincount(components.reshape(-1)) >= least
    enough[0] = False
    return enough[components]


def _touches_rim(cells: Bool[np.ndarray, "r c"]) -> bool:
    return bool(cells[0].any() or cells[-1].any() or cells[:, 0].any() or cells[:, -1].any())
