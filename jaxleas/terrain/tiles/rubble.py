"""Rubble: a grid of tilted rectangles."""

from itertools import pairwise

import numpy as np

from jaxleas.terrain.config import GeneratorConfig
from jaxleas.terrain.tiles.lengths import split
from jaxleas.terrain.tiles.tile import TileFrame, TilePolygons


def rubble_tile(
    frame: TileFrame,
    heights: tuple[float, float],
    config: GeneratorConfig,
    rng: np.random.Generator,
) -> TilePolygons:
    """Return a grid of tilted rectangles, over the slope between the two heights.

    A rectangle's height rises from its centre to its edges by up to +-`rise` along each axis.
    """
    count = max(1, round(frame.size / float(np.mean(config.rubble.cell))))
    edges_s, edges_t = (
        np.concatenate([[0.0], np.cumsum(split(rng, frame.size, count, config.rubble.cell))])
        for _ in range(2)
    )
    surfaces, steepest = [], 0.0
    for s_min, s_max in pairwise(edges_s):
        for t_min, t_max in pairwise(edges_t):
            rise = rng.uniform(-config.rubble.rise, config.rubble.rise, size=2)
            steepest = max(steepest, float(np.abs(rise).sum()))
            middle = heights[0] + (heights[1] - heights[0]) * 0.5 * (s_min + s_max) / frame.size
            slope = 2.0 * rise / np.array([s_max - s_min, t_max - t_min])
            rectangle = (s_min, s_max, t_min - 0.5 * frame.size, t_max - 0.5 * frame.size)
            surfaces.append(frame.rectangle(rectangle, middle, (slope[0], slope[1])))
    return TilePolygons(surfaces, difficulty=steepest / (2.0 * config.rubble.rise))
