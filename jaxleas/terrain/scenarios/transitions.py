"""Rubble, bridges and stairs to cross, one at a time or in one terrain."""

from dataclasses import replace
from typing import Literal

import numpy as np

from jaxleas.terrain.scenarios.scenario import (
    CONFIG,
    FAR,
    NEAR,
    SIZE,
    Scenario,
    around,
    compose,
    near_and_far,
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

TransitionKind = Literal["rubble", "bridge", "stairs_up", "stairs_down"]
EVALUATION_KINDS: tuple[TransitionKind, ...] = ("rubble", "bridge", "stairs_down", "stairs_up")
"""Kinds of transitions, in the order of T fig. 3.16."""


def transition(kind: TransitionKind, seed: int) -> Scenario:
    """Return a flat tile, one random transition, a flat tile (T fig. 3.16).

    Tiles of 2 m lie in a row along x; transitions are those of the generator, and bridges are its
    narrow ones. Around them is void. Starts: near and far; goal: the middle metre of the last tile.
    """
    middle, rise = _middle(kind, tile_frame(1), 0.0, random_stream(kind, seed))
    parts = [flat_tile(tile_frame(0), 0.0), middle, flat_tile(tile_frame(2), rise)]
    return Scenario(kind, compose(parts), near_and_far(SIZE), around(2.5 * SIZE, 0.0, 0.5))


def bridge_ahead(seed: int) -> Scenario:
    """Return the bridge of `transition`, with starts right before it (T table 4.2, fig. 4.10).

    "A small area from where all our steering methods can generate valid guide paths": 0.25 to
    1.75 m before the bridge and within 0.25 m of its middle, so that the straight line to the goal
    stays within the 0.1 m beside the bridge that R* allows. Goal: 0.1 m around the middle of the
    last tile.
    """
    scenario = transition("bridge", seed)
    start = (SIZE - FAR[1], SIZE - NEAR[0], -0.25, 0.25)
    goal = around(2.5 * SIZE, 0.0, 0.1)
    return replace(scenario, name="bridge_ahead", start_areas=(start,), goal_area=goal)


def evaluation_terrain(seed: int) -> tuple[Scenario, ...]:
    """Return the four tasks of one terrain with four transitions in a row (T fig. 3.16).

    Five flat tiles and between them rubble, a narrow bridge, stairs down and stairs up, along x.
    Each task begins on the flat tile before its transition (near and far) and ends in the middle
    metre of the one behind. (The thesis's picture gives the kinds, not the sizes.)
    """
    rng = random_stream("evaluation_terrain", seed)
    height, parts, ends = 0.0, [flat_tile(tile_frame(0), 0.0)], []
    for index, kind in enumerate(EVALUATION_KINDS):
        column = 2 * index + 1
        middle, rise = _middle(kind, tile_frame(column), height, rng)
        height += rise
        parts += [middle, flat_tile(tile_frame(column + 1), height)]
        ends.append((kind, column * SIZE))
    scene = compose(parts)
    return tuple(
        Scenario(kind, scene, near_and_far(edge), around(edge + 1.5 * SIZE, 0.0, 0.5))
        for kind, edge in ends
    )


def _middle(
    kind: TransitionKind, frame: TileFrame, height: float, rng: np.random.Generator
) -> tuple[TilePolygons, float]:
    """Return the tile of a transition that begins at `height`, and its rise [m]."""
    climb = rng.uniform(*CONFIG.stairs.climb)
    if kind == "rubble":
        return rubble_tile(frame, (height, height), CONFIG, rng), 0.0
    if kind == "bridge":
        rise = rng.uniform(-CONFIG.bridge.rise, CONFIG.bridge.rise)
        return bridge_tile(frame, (height, height + rise), CONFIG, rng, wide=False), rise
    rise = climb if kind == "stairs_up" else -climb
    return stairs_tile(frame, (height, height + rise), CONFIG, rng), rise
