"""Tiles: one function per kind, which returns the polygons that fill one cell of the grid.

Every function draws in its tile's frame: s runs along the tile's direction from the entry edge
(s = 0) to the exit edge (s = size), t across it to the left, in [-size/2, size/2].
"""

from dataclasses import dataclass, field
from enum import StrEnum
from itertools import pairwise

import numpy as np
from jaxtyping import Float

from jaxleas.terrain.config import GeneratorConfig
from jaxleas.terrain.polygons import box_faces

Rectangle = tuple[float, float, float, float]
"""Rectangle s_min, s_max, t_min, t_max [m]."""


class TileKind(StrEnum):
    """Kinds of tiles; Flat and Obstacles are initial, the others transitions."""

    FLAT = "flat"
    OBSTACLES = "obstacles"
    RUBBLE = "rubble"
    BRIDGE = "bridge"
    STAIRS = "stairs"
    HOLE = "hole"
    WALL = "wall"
    VOID = "void"

    @property
    def is_initial(self) -> bool:
        """Whether a robot may start and end here."""
        return self in (TileKind.FLAT, TileKind.OBSTACLES)


@dataclass(frozen=True)
class TileFrame:
    """The frame of a tile in the world.

    Attributes:
        entry: x, y of the middle of the entry edge [m].
        direction: unit vector from the entry to the exit edge, along an axis of the world.
        size: edge of the tile [m].
        inset: length by which rectangles are shrunk on each side [m].
    """

    entry: tuple[float, float]
    direction: tuple[float, float]
    size: float
    inset: float

    def world(self, points: Float[np.ndarray, "V 2"]) -> Float[np.ndarray, "V 2"]:
        """Return points (s, t) of the tile in the world [m]."""
        along = np.array(self.direction, dtype=np.float64)
        left = np.array([-along[1], along[0]])
        return np.array(self.entry) + points[:, :1] * along + points[:, 1:] * left


@dataclass(frozen=True)
class TilePolygons:
    """The polygons of a tile, and its difficulty (see `links.Link.difficulty`)."""

    surfaces: list[Float[np.ndarray, "V 3"]] = field(default_factory=list)
    boxes: list[dict[str, Float[np.ndarray, "4 3"]]] = field(default_factory=list)
    difficulty: float = 0.0


def flat_tile(frame: TileFrame, height: float) -> TilePolygons:
    """Return one horizontal rectangle."""
    half = 0.5 * frame.size
    return TilePolygons([_rectangle(frame, (0.0, frame.size, -half, half), height)])


def obstacle_tile(
    frame: TileFrame, height: float, config: GeneratorConfig, rng: np.random.Generator
) -> TilePolygons:
    """Return a flat tile with upright boxes, each in a different quarter, off the centre."""
    quarters = rng.permutation([(1, 1), (-1, 1), (-1, -1), (1, -1)])[: config.obstacles.count]
    boxes = [_box(frame, height, config, rng, quarter) for quarter in quarters]
    return TilePolygons(flat_tile(frame, height).surfaces, boxes, difficulty=float(len(boxes)))


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
            surfaces.append(_rectangle(frame, rectangle, middle, (slope[0], slope[1])))
    return TilePolygons(surfaces, difficulty=steepest / (2.0 * config.rubble.rise))


def bridge_tile(
    frame: TileFrame,
    heights: tuple[float, float],
    config: GeneratorConfig,
    rng: np.random.Generator,
    wide: bool | None = None,
) -> TilePolygons:
    """Return one rectangle from edge to edge, sloped between the two heights; void beside it."""
    drawn = rng.random() < config.bridge.wide_probability
    interval = config.bridge.wide if (drawn if wide is None else wide) else config.bridge.narrow
    width = min(rng.uniform(*interval), frame.size)
    slope = (heights[1] - heights[0]) / frame.size
    rectangle = (0.0, frame.size, -0.5 * width, 0.5 * width)
    surface = _rectangle(frame, rectangle, 0.5 * (heights[0] + heights[1]), (slope, 0.0))
    return TilePolygons([surface], difficulty=1.0 - width / frame.size)


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
        surfaces.append(_rectangle(frame, (edges[step], edges[step + 1], -half, half), z))
    return TilePolygons(surfaces + _landings(frame, edges, heights), difficulty=abs(climb))


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
        _rectangle(frame, part, heights[0])
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
    begin = rng.uniform(0.0, min(0.5, frame.size - thickness))
    corners = frame.world(_corners((begin, begin + thickness, low, high), 0.0))
    box = box_faces(corners, heights[0], heights[0] + rng.uniform(*config.detour.height))
    surfaces = flat_tile(frame, heights[0]).surfaces
    return TilePolygons(surfaces, [box], difficulty=(high - low) / frame.size)


def split(
    rng: np.random.Generator, total: float, count: int, interval: tuple[float, float]
) -> Float[np.ndarray, " count"]:
    """Return `count` random lengths that sum to `total`, each in the interval if possible.

    Random lengths are scaled to the total, then moved towards equal ones until all fit.
    """
    drawn = rng.uniform(*interval, size=count)
    spread = drawn * (total / drawn.sum()) - total / count
    room = np.where(spread > 0.0, interval[1] - total / count, total / count - interval[0])
    scale = np.divide(room, np.abs(spread), out=np.ones(count), where=np.abs(spread) > 1e-12)
    return total / count + spread * float(np.clip(scale.min(), 0.0, 1.0))


def _landings(
    frame: TileFrame, edges: np.ndarray, heights: tuple[float, float]
) -> list[np.ndarray]:
    half, shortest = 0.5 * frame.size, 3.0 * frame.inset + 1e-3
    before, after = (0.0, edges[0], -half, half), (edges[-1], frame.size, -half, half)
    return [
        _rectangle(frame, rectangle, height)
        for rectangle, height in ((before, heights[0]), (after, heights[1]))
        if rectangle[1] - rectangle[0] > shortest
    ]


def _rectangle(
    frame: TileFrame, rectangle: Rectangle, middle: float, slope: tuple[float, float] = (0.0, 0.0)
) -> Float[np.ndarray, "4 3"]:
    """Return an inset rectangle whose centre has the height `middle` [m], tilted by `slope`."""
    s_min, s_max, t_min, t_max = rectangle
    centre = np.array([0.5 * (s_min + s_max), 0.5 * (t_min + t_max)])
    corners = _corners(rectangle, frame.inset)
    z = middle + (corners - centre) @ np.array(slope)
    return np.column_stack([frame.world(corners), z])


def _corners(rectangle: Rectangle, inset: float) -> Float[np.ndarray, "4 2"]:
    s_min, s_max = rectangle[0] + inset, rectangle[1] - inset
    t_min, t_max = rectangle[2] + inset, rectangle[3] - inset
    return np.array([[s_min, t_min], [s_max, t_min], [s_max, t_max], [s_min, t_max]])


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
    footprint = _corners((middle + low[0], middle + high[0], low[1], high[1]), 0.0)
    return box_faces(frame.world(footprint), height, height + rng.uniform(*config.obstacles.height))
