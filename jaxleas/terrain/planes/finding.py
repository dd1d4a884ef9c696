"""The search for planar surfaces in a height map."""

import numpy as np
from jaxtyping import Bool, Float, Int

from jaxleas.terrain.height_map import HeightMap
from jaxleas.terrain.planes.alike import settle_alike
from jaxleas.terrain.planes.assigning import assign
from jaxleas.terrain.planes.bearing import without_corners_in_the_air
from jaxleas.terrain.planes.found import Cell, FoundSurfaces
from jaxleas.terrain.planes.growing import flat_windows, grow_regions
from jaxleas.terrain.planes.joining import joined, regions_of
from jaxleas.terrain.planes.noise import LEAST_NOISE, measured_noise
from jaxleas.terrain.planes.pieces import closed, is_wide, pieces
from jaxleas.terrain.planes.polygons import polygons_of
from jaxleas.terrain.planes.region import Growth, Region
from jaxleas.terrain.planes.rises import rises
from jaxleas.terrain.planes.settings import PLANE_SEARCH, PlaneSearch
from jaxleas.terrain.planes.windows import Windows, fit_windows
from jaxleas.terrain.scene import Polygons
from jaxleas.types import is_ground

WIDTHS = (0.3, 0.2, 0.1)
"""Widths of the windows in which planes are fitted, the largest first [m]."""
ROUNDS = 2
"""Number of times that cells are assigned again."""
BLUR = 3.0
"""Standard deviations of the noise by which surfaces are drawn in, besides half a cell."""
PART = 0.5
"""Part of the smallest area of a surface below which a convex part of one is left out."""


def find_surfaces(height_map: HeightMap, search: PlaneSearch = PLANE_SEARCH) -> FoundSurfaces:
    """Return the planar surfaces of a height map as convex polygons.

    Planes are fitted in windows around all cells; regions grow from the flattest windows; each
    cell goes to the plane that fits its surroundings best, right up to the edges; regions are
    fitted without outliers, and their outlines cut into convex parts. The steps are those of
    Grandia et al. 2022 (arXiv 2208.08373, section IV); how noise and edges are treated is not.

    Args:
        height_map: height map.
        search: what counts as a surface.
    """
    cell = height_map.resolution
    known = is_ground(height_map.heights)
    heights, middle = _centred(height_map.heights, known)
    sizes = sorted({_odd(width / cell) for width in WIDTHS}, reverse=True)
    scales = [fit_windows(heights, known, size) for size in sizes]
    noise = search.noise or measured_noise(scales[-1], search.roughness)
    least = search.min_area / cell**2
    ground = Growth(heights, known, noise, cell, max(3, int(least)))
    owner = _owners(ground, grow_regions(ground, scales), scales)
    regions = _whole(ground, owner, round(search.closing / cell))
    fit = [_fit(ground, each) for each in regions]
    cells = _left_over(ground, scales[-1], np.tan(np.radians(search.max_slope)) * cell)
    surface = np.full(known.shape, -1, np.int32)
    inset = _known_to(cell, noise) if search.inset is None else search.inset
    polygons: Polygons = {}
    good = []
    for region, off in zip(regions, fit, strict=True):
        kind = _kind(region, off, search, cell)
        cells[region.box][region.cells] = kind
        if kind is not Cell.SURFACE:
            continue
        lifted = region.lifted(middle)
        parts = polygons_of(lifted, height_map, inset, PART * search.min_area)
        if inset >= 0.5 * cell:  # else the cells around a corner are not the surface's alone
            parts = without_corners_in_the_air(parts, height_map, max(noise, off))
        if not parts:
            cells[region.box][region.cells] = Cell.SMALL
            continue
        surface[region.box][region.cells] = len(good)
        polygons |= _named(len(good), parts)
        good.append(off)
    return FoundSurfaces(
        polygons, surface, cells, np.array(good), noise, inset, cell, rises(height_map)
    )


def _known_to(cell: float, noise: float) -> float:
    """Return how well an edge is known [m]: to half a cell, and noise blurs where planes cross."""
    return 0.5 * cell + (BLUR * noise if noise > LEAST_NOISE else 0.0)


def _centred(
    heights: Float[np.ndarray, "R C"], known: Bool[np.ndarray, "R C"]
) -> tuple[Float[np.ndarray, "R C"], float]:
    """Return heights about their median, zero where unknown, and the median [m]."""
    middle = float(np.median(heights[known])) if known.any() else 0.0
    return np.where(known, heights.astype(np.float64) - middle, 0.0), middle


def _odd(cells: float) -> int:
    """Return the nearest odd number of cells, 3 at least."""
    return max(3, 2 * round((cells - 1.0) / 2.0) + 1)


def _owners(ground: Growth, regions: list[Region], scales: list[Windows]) -> np.ndarray:
    """Return the number of each cell's region.

    Cells are assigned again with planes fitted to all cells, without regions that turned out too
    small or too narrow: their cells go to the others.
    """
    small, large = scales[-1].size, scales[0].size
    owner = joined(ground, assign(ground, regions, small))
    for _ in range(ROUNDS):
        regions = [each for each in regions_of(ground, owner) if is_wide(each, ground.least, small)]
        owner = assign(ground, regions, small)
    settle_alike(ground, regions, owner, large)
    return joined(ground, owner)


def _whole(ground: Growth, owner: Int[np.ndarray, "R C"], widest: int) -> list[Region]:
    """Return regions that hang together, their small holes closed, in the order of their boxes."""
    found = [closed(ground, each, owner, widest) for each in pieces(regions_of(ground, owner))]
    return sorted(found, key=lambda each: (each.box[0].start, each.box[1].start))


def _fit(ground: Growth, region: Region) -> float:
    """Return the root mean square distance of a region's cells from its plane [m]."""
    cells = region.cells & ground.known[region.box]
    gap = ground.heights[region.box][cells] - region.plane.over(region.box)[cells]
    return float(np.sqrt((gap**2).mean()))


def _kind(region: Region, fit: float, search: PlaneSearch, cell: float) -> Cell:
    slope = np.hypot(region.plane.along_rows, region.plane.along_columns) / cell
    if slope > np.tan(np.radians(search.max_slope)) + 1e-9:
        return Cell.STEEP
    if region.size * cell**2 * np.hypot(1.0, slope) < search.min_area:
        return Cell.SMALL
    return Cell.ROUGH if fit > search.roughness else Cell.SURFACE


def _left_over(ground: Growth, windows: Windows, steepest: float) -> Int[np.ndarray, "R C"]:
    """Return what cells are if in no region: void, too steep, even but too small, or too rough."""
    from scipy.ndimage import uniform_filter

    steep = np.hypot(windows.along_rows, windows.along_columns) > steepest
    flat = flat_windows(windows, ground.noise).astype(np.float64)
    fitted = np.isfinite(windows.deviation).astype(np.float64)
    even = uniform_filter(flat, windows.size) >= 0.5 * uniform_filter(fitted, windows.size)
    kinds = np.where(steep, Cell.STEEP, np.where(even, Cell.SMALL, Cell.ROUGH))
    return np.where(ground.known, kinds, Cell.VOID).astype(np.int8)


def _named(number: int, parts: list[np.ndarray]) -> Polygons:
    if len(parts) == 1:
        return {f"surface_{number}": parts[0]}
    return {f"surface_{number}_{part}": each for part, each in enumerate(parts)}
