"""Limits: an obstacle across the tile that a robot just can, or just cannot, cross."""

import math

import numpy as np

from jaxleas.terrain.config import GeneratorConfig, LimitsConfig
from jaxleas.terrain.limit import Bar, Limit
from jaxleas.terrain.tiles.across import bars_across, ground_across
from jaxleas.terrain.tiles.tile import TileFrame, TileKind, TilePolygons

LIMITS = (TileKind.LEDGE, TileKind.GAP, TileKind.BARRIER, TileKind.POSTS)
_SQUARE_ON = 0.8
"""Share of the room in the tile that the obstacle's place takes up."""


def limit_tile(
    frame: TileFrame,
    heights: tuple[float, float],
    config: GeneratorConfig,
    rng: np.random.Generator,
    kind: TileKind,
) -> TilePolygons:
    """Return a tile with a straight obstacle across it, at any angle up to 45 degrees.

    Args:
        frame: frame of the tile.
        heights: heights of the entry and the exit edge [m]; they differ for a ledge alone.
        config: configuration of the generator.
        rng: source of random numbers.
        kind: one of `LIMITS`.
    """
    limit, difficulty = _drawn(kind, heights[1] - heights[0], config.limits, rng)
    half, most = 0.5 * frame.size, math.radians(config.limits.angle)
    angle = rng.uniform(-most, most)
    # The line leaves the tile by its sides, never by the edges where a robot enters or leaves.
    room = _SQUARE_ON * max(0.0, half * (1.0 - math.tan(abs(angle))) - limit.gap)
    at = rng.uniform(-room, room)
    shift = rng.uniform(0.0, limit.period) if math.isfinite(limit.period) else 0.0
    own = half - frame.inset
    ground = ground_across(limit, angle, (own, own), at)
    boxes = bars_across(limit, angle, half / math.cos(angle), shift, at)
    return TilePolygons(
        [_placed(frame, part, heights[0]) for part in ground if len(part) >= 3],
        [
            {face: _placed(frame, corners, heights[0]) for face, corners in box.items()}
            for box in boxes
        ],
        difficulty,
    )


def _drawn(
    kind: TileKind, rise: float, config: LimitsConfig, rng: np.random.Generator
) -> tuple[Limit, float]:
    """Return an obstacle of a kind, and its difficulty (see `links.Link.difficulty`)."""
    if kind is TileKind.LEDGE:
        return Limit(rise=rise), abs(rise)
    if kind is TileKind.GAP:
        gap = rng.uniform(*config.gap)
        return Limit(gap=gap), gap
    if kind is TileKind.BARRIER:
        high = rng.uniform(*(config.hurdle if rng.random() < 0.5 else config.wall))
        bar = Bar(rng.uniform(*config.thickness), math.inf, 0.0, high)
        return Limit(bars=(bar,)), high
    thick, high = rng.uniform(*config.post), rng.uniform(*config.post_height)
    room = rng.uniform(*config.room)
    return Limit(bars=(Bar(thick, thick, 0.0, high),), period=thick + room), -room


def _placed(frame: TileFrame, corners: np.ndarray, height: float) -> np.ndarray:
    """Return corners in the world, of points around the tile's middle at height 0."""
    along = corners[:, :2] + np.array([0.5 * frame.size, 0.0])
    return np.column_stack([frame.to_world(along), corners[:, 2] + height])
