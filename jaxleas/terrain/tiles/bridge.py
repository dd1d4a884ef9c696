"""Bridges: one rectangle over the void, level or sloped."""

import numpy as np

from jaxleas.terrain.config import GeneratorConfig
from jaxleas.terrain.tiles.tile import TileFrame, TilePolygons


def bridge_tile(
    frame: TileFrame,
    heights: tuple[float, float],
    config: GeneratorConfig,
    rng: np.random.Generator,
    wide: bool | None = None,
) -> TilePolygons:
    """Return one rectangle from edge to edge, sloped between the two heights; the rest is void."""
    drawn = rng.random() < config.bridge.wide_probability
    interval = config.bridge.wide if (drawn if wide is None else wide) else config.bridge.narrow
    width = min(rng.uniform(*interval), frame.size)
    slope = (heights[1] - heights[0]) / frame.size
    rectangle = (0.0, frame.size, -0.5 * width, 0.5 * width)
    surface = frame.rectangle(rectangle, 0.5 * (heights[0] + heights[1]), (slope, 0.0))
    return TilePolygons([surface], difficulty=1.0 - width / frame.size)
