"""Polygons to height maps: each cell centre has the height of the highest polygon over it."""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Float

from jaxleas.terrain.areas import bounds
from jaxleas.terrain.cells import covered_cells, padded_groups
from jaxleas.terrain.height_map import MAX_CELLS, HeightMap, require_resolution
from jaxleas.terrain.polygons import VERTICAL_SLOPE, upwardness
from jaxleas.terrain.scene import Scene
from jaxleas.terrain.sheets import raise_sheets
from jaxleas.types import InputError

DEFAULT_RESOLUTION = 0.04
CLOSING = 0.01
"""Length by which polygons are grown [m]: contact surfaces are inset by 1 cm per side (generator),
and otherwise the seams between tiles and steps would be one-cell cracks of void."""


def rasterise(
    scene: Scene, resolution: float = DEFAULT_RESOLUTION, margin: float = 0.5
) -> HeightMap:
    """Return the height map of the surfaces that feet may touch, of walls and of obstacles.

    Of a vertical face that the cells around do not hold, the upper edge counts. Skipped are
    ceilings, and surfaces that `touch` gives to palms alone unless they are walls. Cell edges lie
    at multiples of the resolution.

    Args:
        scene: scene to rasterise.
        resolution: edge of a cell [m].
        margin: width of void around the scene [m].

    Raises:
        InputError: the resolution is absurd, or the map would be too large.
    """
    return rasterise_polygons(blocking(scene), resolution, margin, grow=CLOSING)


def blocking(scene: Scene) -> list[Float[np.ndarray, "V 3"]]:
    """Return the polygons of a scene of which its height map is made."""
    walls = [
        vertices
        for name, vertices in scene.surfaces.items()
        if name not in scene.walkable and _is_wall(scene, name)
    ]
    return [*scene.walkable.values(), *walls, *scene.obstacles.values()]


def _is_wall(scene: Scene, name: str) -> bool:
    """Tell whether a surface for palms stands in the way: vertical, or leaning and unnamed."""
    upward = upwardness(scene.surfaces[name])
    return abs(upward) <= VERTICAL_SLOPE or (upward > 0.0 and name not in scene.touch)


def rasterise_polygons(
    polygons: Sequence[Float[np.ndarray, "V 3"]] | Float[np.ndarray, "N V 3"],
    resolution: float,
    margin: float,
    grow: float = 0.0,
    where: str = "scene",
) -> HeightMap:
    """Return the height map of convex polygons, each side moved outwards by `grow` [m].

    A sharp corner grows no further than that beyond the polygon's bounding box. Of vertical
    polygons that the map does not hold otherwise, the upper edge counts.
    """
    require_resolution(resolution, where)
    groups = padded_groups(polygons)
    sides = [bounds(each) for each in groups]
    lowest = np.min([low for low, _ in sides], axis=0)
    highest = np.max([high for _, high in sides], axis=0)
    low = np.floor((lowest[:2] - margin) / resolution)
    high = np.ceil((highest[:2] + margin) / resolution)
    columns, rows = (high - low).tolist()
    if not rows * columns <= MAX_CELLS:
        raise InputError(
            f"{where}: {rows:.6g} x {columns:.6g} cells of {resolution:g} m, more than the "
            f"{MAX_CELLS} accepted; take a coarser resolution or a smaller terrain"
        )
    origin = (low + 0.5) * resolution
    heights = np.full(int(rows) * int(columns), -np.inf, dtype=np.float32)
    shape, place = (int(rows), int(columns)), (float(origin[0]), float(origin[1]))
    frame = HeightMap(heights.reshape(shape), resolution, place)
    for cell, z in covered_cells(groups, frame, grow):
        np.maximum.at(heights, cell, z.astype(np.float32))
    raise_sheets(frame.heights, groups, origin, resolution)
    heights[np.isneginf(heights)] = np.nan
    return frame
