"""Detours: level ground with something to walk around, a hole or a wall."""

import numpy as np

from jaxleas.terrain.config import GeneratorConfig
from jaxleas.terrain.polygons import box_faces
from jaxleas.terrain.tiles.initial import flat_tile
from jaxleas.terrain.tiles.tile import TileFrame, TilePolygons

_WALL_NEAR = 0.5  # largest distance of a wall from the entry edge [m]


def hole_tile(
    frame: TileFrame,
    heights: tuple[float, float],
    config: GeneratorConfig,
    rng: np.random.Generator,
) -> TilePolygons:
    """Return a level tile with a rectangular hole that leaves a rim at either side."""
    half, rim = 0.5 * frame.size, config.detour.rim
    width = min(rng.uniform(*config.detour.width), frame.size - 2.0 * rim)
    low = rng.uniform(rim - half, half - rim - width)
    high = low + width
    length = min(rng.uniform(*config.detour.length), frame.size)
    begin = rng.uniform(0.0, frame.size - length)
    parts = [
        (0.0, begin, -half, half),
        (begin + length, frame.size, -half, half),
        (begin, begin + length, -half, low),
        (begin, begin + length, high, half),
    ]
    least = 3.0 * frame.inset + 1e-3
    surfaces = [
        frame.rectangle(part, heights[0])
        for part in parts
        if part[1] - part[0] > least and part[3] - part[2] > least
    ]
    return TilePolygons(surfaces, difficulty=(high - low) / frame.size)


def wall_tile(
    frame: TileFrame,
    heights: tuple[float, float],
    config: GeneratorConfig,
    rng: np.random.Generator,
) -> TilePolygons:
    """Return a level tile with a wall across it, from one side to a passage at the other."""
    half, width = 0.5 * frame.size, rng.uniform(*config.detour.width)
    low, high = (-half, width - half) if rng.random() < 0.5 else (half - width, half)
    thickness = min(rng.uniform(*config.detour.thickness), frame.size)
    # Close to one end: right in front of a robot from that end, far from one that comes back.
    begin = rng.uniform(0.0, min(_WALL_NEAR, frame.size - thickness))
    outline = frame.outline((begin, begin + thickness, low, high))
    box = box_faces(outline, heights[0], heights[0] + rng.uniform(*config.detour.height))
    surfaces = flat_tile(frame, heights[0]).surfaces
    return TilePolygons(surfaces, [box], difficulty=(high - low) / frame.size)
