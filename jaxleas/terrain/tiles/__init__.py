"""Tiles: one function per kind, which returns the polygons that fill one cell of the grid.

Every function draws in its tile's frame: s runs along the tile's direction from the entry edge
(s = 0) to the exit edge (s = size), t across it to the left, in [-size/2, size/2].
"""

from jaxleas.terrain.tiles.across import bars_across, ground_across
from jaxleas.terrain.tiles.bridge import bridge_tile
from jaxleas.terrain.tiles.detours import hole_tile, wall_tile
from jaxleas.terrain.tiles.initial import flat_tile, obstacle_tile
from jaxleas.terrain.tiles.lengths import split
from jaxleas.terrain.tiles.limits import LIMITS, limit_tile
from jaxleas.terrain.tiles.rubble import rubble_tile
from jaxleas.terrain.tiles.stairs import stairs_tile
from jaxleas.terrain.tiles.tile import TileFrame, TileKind, TilePolygons

__all__ = [
    "LIMITS",
    "TileFrame",
    "TileKind",
    "TilePolygons",
    "bars_across",
    "bridge_tile",
    "flat_tile",
    "ground_across",
    "hole_tile",
    "limit_tile",
    "obstacle_tile",
    "rubble_tile",
    "split",
    "stairs_tile",
    "wall_tile",
]
