"""Initial tiles, where a robot may start and end: level ground, with boxes or without."""

import numpy as np

from jaxleas.terrain.config import GeneratorConfig
from jaxleas.terrain.polygons import box_faces
from jaxleas.terrain.tiles.tile import TileFrame, TilePolygons


def flat_tile(frame: TileFrame, height: float) -> TilePolygons:
    """Return one horizontal rectangle."""
    half = 0.5 * frame.size
    return TilePolygons([frame.rectangle((0.0, frame.size, -half, half), height)])


def obstacle_tile(
    frame: TileFrame, height: float, config: GeneratorConfig, rng: np.random.Generator
) -> TilePolygons:
    """Return a flat tile with upright boxes, each in a different quarter, off the centre."""
    quarters = rng.permutation([(1, 1), (-1, 1), (-1, -1), (1, -1)])[: config.obstacles.count]
    boxes = [_box(frame, height, config, rng, quarter) for quarter in quarters]
    return TilePolygons(flat_tile(frame, height).surfaces, boxes, difficulty=float(len(boxes)))


def _box(
    frame: TileFrame,
    height: float,
    config: GeneratorConfig,
    rng: np.random.Generator,
    quarter: np.ndarray,
) -> dict[str, np.ndarray]:
    near = rng.uniform(*config.obstacles.distance, size=2)
    size = np.array([rng.uniform(*config.obstacles.length), rng.uniform(*config.obstacles.width)])
    if rng.random() < 0.5:
        size = size[::-1]
    far = np.minimum(near + size, 0.5 * frame.size)
    low, high = np.minimum(quarter * near, quarter * far), np.maximum(quarter * near, quarter * far)
    middle = 0.5 * frame.size
    outline = frame.outline((middle + low[0], middle + high[0], low[1], high[1]))
    return box_faces(outline, height, height + rng.uniform(*config.obstacles.height))
