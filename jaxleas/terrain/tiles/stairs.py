"""Stairs: steps of equal risers, with level landings before and after them."""

import numpy as np

from jaxleas.terrain.config import GeneratorConfig
from jaxleas.terrain.tiles.lengths import split
from jaxleas.terrain.tiles.tile import TileFrame, TilePolygons


def stairs_tile(
    frame: TileFrame,
    heights: tuple[float, float],
    config: GeneratorConfig,
    rng: np.random.Generator,
) -> TilePolygons:
    """Return steps of equal risers between the two heights, up or down.

    The source gives depth and width of a step; the riser follows from the climb and the number
    of steps, n steps between two tiles making n + 1 risers, as in the author's arenas. Mostly the
    steps fill the tile (5 to 10 steps). With `landing_probability` they are fewer, so higher, as
    far as `riser_max` allows, and level landings fill the rest of the tile: risers from 0.04 to
    0.2 m occur in training. `riser_max` always takes precedence over the number of steps.
    """
    climb, depth = heights[1] - heights[0], config.stairs.depth
    most = max(1, int(frame.size / depth[0] + 1e-9))
    fewest = min(most, max(1, int(np.ceil(abs(climb) / config.stairs.riser_max - 1e-9)) - 1))
    full = max(fewest, int(np.ceil(frame.size / depth[1] - 1e-9)))
    if rng.random() < config.stairs.landing_probability:
        count = int(rng.integers(fewest, full + 1))
        shortest = max(count * depth[0], abs(climb) / config.stairs.slope_max)
        length = min(frame.size, rng.uniform(shortest, max(shortest, count * depth[1])))
    else:
        count, length = int(rng.integers(full, most + 1)), frame.size
    before = rng.uniform(0.0, frame.size - length)
    edges = before + np.concatenate([[0.0], np.cumsum(split(rng, length, count, depth))])
    surfaces = []
    for step in range(count):
        half = 0.5 * min(rng.uniform(*config.stairs.width), frame.size)
        z = heights[0] + climb * (step + 1) / (count + 1)
        surfaces.append(frame.rectangle((edges[step], edges[step + 1], -half, half), z))
    return TilePolygons(surfaces + _landings(frame, edges, heights), difficulty=abs(climb))


def _landings(
    frame: TileFrame, edges: np.ndarray, heights: tuple[float, float]
) -> list[np.ndarray]:
    half, shortest = 0.5 * frame.size, 3.0 * frame.inset + 1e-3
    before, after = (0.0, edges[0], -half, half), (edges[-1], frame.size, -half, half)
    return [
        frame.rectangle(rectangle, height)
        for rectangle, height in ((before, heights[0]), (after, heights[1]))
        if rectangle[1] - rectangle[0] > shortest
    ]
