"""Long courses: level ground to turn on, the long course, the circuit."""

import numpy as np

from jaxleas.terrain.config import GeneratorConfig
from jaxleas.terrain.scenarios.scenario import (
    CONFIG,
    SIZE,
    Scenario,
    around,
    compose,
    floor,
    random_stream,
    tile_frame,
)
from jaxleas.terrain.tiles import (
    TileFrame,
    TilePolygons,
    bridge_tile,
    flat_tile,
    rubble_tile,
    stairs_tile,
)

LONG_KINDS = ("rubble", "bridge", "stairs up", "stairs down", "stairs up")
LONG_STAIRS = 8
"""Number of steps in each of the long course's stairs: with 25 rectangles of rubble, 6 tiles and
the bridge these are the published 56 surfaces."""


def rotation(seed: int) -> Scenario:
    """Return level ground to turn and walk on (T 4.3.1, table 4.1): the same for every seed.

    The ground is 8 m along x and 5 m across, one surface. Starts: the square of 1 m around the
    origin; goal: 0.25 m around a point 3.5 m ahead: distances of 3 to 4 m, as published.
    """
    del seed
    scene = compose([floor((-2.5, 5.5, -2.5, 2.5))])
    return Scenario("rotation", scene, (around(0.0, 0.0, 0.5),), around(3.5, 0.0, 0.25))


def long_course(seed: int) -> Scenario:
    """Return rubble, a bridge and three stairs in a row (T figs. 5.4, 5.8, table 5.1).

    Six flat tiles of 2 m with five transitions between: 22 m, and the published 56 surfaces. The
    stairs (up, down, up; the source shows both kinds and gives neither order nor height) have 8
    steps each and climb 0.4 to 1 m; the bridge is a narrow one. Waypoints: the middles of the flat
    tiles, which the baselines need (T 5.2.4) and every method receives. Start: the middle 0.8 m of
    the first tile.
    """
    rng = random_stream("long_course", seed)
    depth = SIZE / LONG_STAIRS
    stairs = CONFIG.stairs.model_copy(update={"depth": (depth, depth), "landing_probability": 0.0})
    config = CONFIG.model_copy(update={"stairs": stairs})
    height, parts = 0.0, [flat_tile(tile_frame(0), 0.0)]
    for index, kind in enumerate(LONG_KINDS):
        rise = _rise(kind, rng.uniform(*stairs.climb))
        frame = tile_frame(2 * index + 1)
        parts.append(_course_tile(kind, frame, (height, height + rise), rng, config))
        height += rise
        parts.append(flat_tile(tile_frame(2 * index + 2), height))
    centres = [((2 * index + 2.5) * SIZE, 0.0) for index in range(len(LONG_KINDS))]
    start, goal = around(0.5 * SIZE, 0.0, 0.4), around(*centres[-1], 0.0)
    return Scenario("long_course", compose(parts), (start,), goal, tuple(centres))


def circuit(seed: int) -> Scenario:
    """Return a round walk over stairs, bridges and rubble (T fig. 3.17, I fig. 8).

    Six flat tiles and six of the generator's transitions form a ring in a grid of 5 x 3 tiles;
    stairs up come first and stairs down fourth; two bridges (at least one narrow), rubble and
    flat ground are shuffled in between. Waypoints: the middles of the flat tiles, the first one
    last; start: the middle metre of the first tile.
    """
    rng = random_stream("circuit", seed)
    ring = [(0, 0), (0, 1), (0, 2), (0, 3), (0, 4), (1, 4), (2, 4), (2, 3), (2, 2), (2, 1), (2, 0)]
    ring.append((1, 0))
    climb = rng.uniform(*CONFIG.stairs.climb)
    level = rng.permutation(["bridge", "wide bridge", "rubble", "flat"]).tolist()
    kinds = ["stairs up", level[0], level[1], "stairs down", level[2], level[3]]
    height, parts = 0.0, []
    for index, kind in enumerate(kinds):
        here, between = ring[2 * index], ring[2 * index + 1]
        rise = _rise(kind, climb)
        parts.append(flat_tile(tile_frame(here[1], here[0]), height))
        direction = (float(between[1] - here[1]), float(between[0] - here[0]))
        frame = tile_frame(between[1], between[0], direction)
        parts.append(_course_tile(kind, frame, (height, height + rise), rng))
        height += rise
    centres = [((column + 0.5) * SIZE, row * SIZE) for row, column in ring[::2]]
    start = around(*centres[0], 0.5)
    return Scenario("circuit", compose(parts), (start,), start, (*centres[1:], centres[0]))


def _rise(kind: str, climb: float) -> float:
    return {"stairs up": climb, "stairs down": -climb}.get(kind, 0.0)


def _course_tile(
    kind: str,
    frame: TileFrame,
    heights: tuple[float, float],
    rng: np.random.Generator,
    config: GeneratorConfig = CONFIG,
) -> TilePolygons:
    if kind == "rubble":
        return rubble_tile(frame, heights, config, rng)
    if kind in ("bridge", "wide bridge"):
        return bridge_tile(frame, heights, config, rng, wide=kind == "wide bridge")
    if kind == "flat":
        return flat_tile(frame, heights[0])
    return stairs_tile(frame, heights, config, rng)
