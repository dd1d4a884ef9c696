"""Named terrains to be judged on (T 3.4.2, figures 3.14-3.17; I sec. IV).

The sources draw these terrains without dimensions; the ones chosen here stand in each docstring.
Every scenario is walked in the direction of +x, and is the same, always, for one name and seed.
"""

import zlib
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from jaxleas.terrain.config import GeneratorConfig
from jaxleas.terrain.links import Area
from jaxleas.terrain.polygons import box_faces
from jaxleas.terrain.scene import Scene
from jaxleas.terrain.tiles import (
    TileFrame,
    TilePolygons,
    bridge_tile,
    flat_tile,
    rubble_tile,
    stairs_tile,
)

TransitionKind = Literal["rubble", "bridge", "stairs_up", "stairs_down"]
DeadEndKind = Literal["void", "wall", "platform"]
CONFIG = GeneratorConfig()
SIZE, INSET = CONFIG.tile_size, CONFIG.inset
NEAR, FAR, HALF_WIDTH = (0.25, 0.9), (0.9, 1.75), 0.7
"""Starts before the first edge of what comes, and to either side of the middle [m]."""


@dataclass(frozen=True)
class Scenario:
    """A terrain with a task.

    Attributes:
        name: e.g. "bridge".
        scene: its polygons.
        start_areas: rectangles (x_min, x_max, y_min, y_max) [m]: near and far, or one alone.
        goal_area: rectangle [m].
        waypoints: to be reached in order (x, y) [m]; of the circuit only.
        crossing: whether the goal can be reached; if not, the robot must stop and stay valid.
    """

    name: str
    scene: Scene
    start_areas: tuple[Area, ...]
    goal_area: Area
    waypoints: tuple[tuple[float, float], ...] = ()
    crossing: bool = True


def transition(kind: TransitionKind, seed: int) -> Scenario:
    """Return a flat tile, one random transition, a flat tile (T fig. 3.16).

    Tiles are 2 m and in a row along x, transitions those of the generator; bridges are its narrow
    ones. Around it is void. Starts: near and far; goal: the middle metre of the last tile.
    """
    rng = _rng(kind, seed)
    frame = _tile(1)
    climb = rng.uniform(*CONFIG.stairs.climb)
    if kind == "rubble":
        rise, middle = 0.0, rubble_tile(frame, (0.0, 0.0), CONFIG, rng)
    elif kind == "bridge":
        rise = rng.uniform(-CONFIG.bridge.rise, CONFIG.bridge.rise)
        middle = bridge_tile(frame, (0.0, rise), CONFIG, rng, wide=False)
    else:
        rise = climb if kind == "stairs_up" else -climb
        middle = stairs_tile(frame, (0.0, rise), CONFIG, rng)
    parts = [flat_tile(_tile(0), 0.0), middle, flat_tile(_tile(2), rise)]
    return Scenario(kind, _scene(parts), _near_and_far(SIZE), _around(2.5 * SIZE, 0.0, 0.5))


def hole(seed: int) -> Scenario:
    """Return a floor with a hole between starts and goal (T fig. 3.15, I sec. IV-B.2).

    The floor is 4 m along x and 4 m across, the hole in its middle 1 m along x and 1.1 m across,
    shifted aside by up to 0.25 m: the rims are 1.2 to 1.7 m wide. (The sources give no size; from
    the middle of a wider hole no rim lies within the 0.6 m that LEAS sees to a side, and a local
    method has nothing to steer by.) Starts: 0.5 to 0.9 m before the hole, over 2.4 m of the width;
    goal: 0.2 m around a point 1 m behind the hole.
    """
    shift = _rng("hole", seed).uniform(-0.25, 0.25)
    rim = (shift - 0.55, shift + 0.55)
    floors = [
        (0.0, 1.5, -2.0, 2.0),
        (2.5, 4.0, -2.0, 2.0),
        (1.5, 2.5, -2.0, rim[0]),
        (1.5, 2.5, rim[1], 2.0),
    ]
    scene = _scene([_floor(area) for area in floors])
    return Scenario("hole", scene, ((0.6, 1.0, -1.2, 1.2),), _around(3.5, 0.0, 0.1))


def wall(seed: int) -> Scenario:
    """Return level ground with a wall that leaves a passage at one side (T 4.3.2, scenario B2).

    The ground is 5 m along x and 4 m across; the wall, 0.2 m thick and 1.5 m high, stands half
    way, from one side of the ground to between 0.1 m short of the middle and 0.2 m beyond: the
    passage is 1.8 to 2.1 m wide. The seed chooses the side. Starts: 1 to 1.7 m before the wall,
    in the middle metre; goal: the middle metre 1 to 2 m behind it. Most straight lines hit the
    wall or come closer than half a trunk (0.3 m).
    """
    rng = _rng("wall", seed)
    side, end = rng.choice([-1.0, 1.0]), rng.uniform(-0.1, 0.2)
    low, high = sorted((side * end, -side * 2.0))
    parts = [_floor((0.0, 5.0, -2.0, 2.0)), _box((2.4, 2.6, low, high), 0.0, 1.5)]
    return Scenario("wall", _scene(parts), ((0.7, 1.4, -0.5, 0.5),), _around(4.0, 0.0, 0.5))


def dead_end(kind: DeadEndKind, seed: int) -> Scenario:
    """Return a flat tile before what cannot be crossed, over the whole width; the goal is behind.

    `void`: nothing comes after the tile. `wall`: 0.3 m thick, 0.7 to 2 m high, with a flat tile
    behind. `platform`: a tile 0.6 to 1 m higher. Starts: near (from 0.4 m, so that the trunk is
    clear of a wall whatever its heading) and far.
    """
    name = f"dead_end_{kind}"
    rng = _rng(name, seed)
    parts = [flat_tile(_tile(0), 0.0)]
    if kind == "wall":
        half = 0.5 * SIZE
        parts += [_box((SIZE, SIZE + 0.3, -half, half), 0.0, rng.uniform(*CONFIG.obstacles.height))]
        parts += [_floor((SIZE + 0.3, 2.0 * SIZE + 0.3, -half, half))]
    elif kind == "platform":
        parts += [_platform((SIZE, 2.0 * SIZE, -0.5 * SIZE, 0.5 * SIZE), rng.uniform(0.6, 1.0))]
    goal = _around(1.75 * SIZE, 0.0, 0.5)
    starts = _near_and_far(SIZE, nearest=0.4)
    return Scenario(name, _scene(parts), starts, goal, crossing=False)


def circuit(seed: int) -> Scenario:
    """Return a round walk over stairs, bridges and rubble (T fig. 3.17, I fig. 8).

    Six flat tiles and six of the generator's transitions form a ring in a grid of 5 x 3 tiles;
    stairs up come first and stairs down fourth, two bridges (one narrow for certain), rubble and
    flat ground are shuffled between. Waypoints: the middles of the flat tiles, the first one
    last; start: the middle metre of the first tile.
    """
    rng = _rng("circuit", seed)
    ring = [(0, 0), (0, 1), (0, 2), (0, 3), (0, 4), (1, 4), (2, 4), (2, 3), (2, 2), (2, 1), (2, 0)]
    ring.append((1, 0))
    climb = rng.uniform(*CONFIG.stairs.climb)
    level = rng.permutation(["bridge", "wide bridge", "rubble", "flat"]).tolist()
    kinds = ["stairs up", level[0], level[1], "stairs down", level[2], level[3]]
    height, parts = 0.0, []
    for index, kind in enumerate(kinds):
        here, between = ring[2 * index], ring[2 * index + 1]
        rise = {"stairs up": climb, "stairs down": -climb}.get(kind, 0.0)
        parts.append(flat_tile(_tile(here[1], here[0]), height))
        direction = (float(between[1] - here[1]), float(between[0] - here[0]))
        frame = _tile(between[1], between[0], direction)
        parts.append(_circuit_tile(kind, frame, (height, height + rise), rng))
        height += rise
    centres = [((column + 0.5) * SIZE, row * SIZE) for row, column in ring[::2]]
    start = _around(*centres[0], 0.5)
    return Scenario("circuit", _scene(parts), (start,), start, (*centres[1:], centres[0]))


def _circuit_tile(
    kind: str, frame: TileFrame, heights: tuple[float, float], rng: np.random.Generator
) -> TilePolygons:
    if kind == "rubble":
        return rubble_tile(frame, heights, CONFIG, rng)
    if kind in ("bridge", "wide bridge"):
        return bridge_tile(frame, heights, CONFIG, rng, wide=kind == "wide bridge")
    if kind == "flat":
        return flat_tile(frame, heights[0])
    return stairs_tile(frame, heights, CONFIG, rng)


def _rng(name: str, seed: int) -> np.random.Generator:
    return np.random.default_rng([zlib.crc32(name.encode()), seed])


def _tile(column: int, row: int = 0, direction: tuple[float, float] = (1.0, 0.0)) -> TileFrame:
    """Return the frame of a tile in a grid whose row 0 lies along the x axis."""
    centre = ((column + 0.5) * SIZE, row * SIZE)
    entry = (centre[0] - 0.5 * SIZE * direction[0], centre[1] - 0.5 * SIZE * direction[1])
    return TileFrame(entry, direction, SIZE, INSET)


def _corners(area: Area, inset: float) -> np.ndarray:
    x_min, x_max, y_min, y_max = area
    x_min, x_max, y_min, y_max = x_min + inset, x_max - inset, y_min + inset, y_max - inset
    return np.array([[x_min, y_min], [x_max, y_min], [x_max, y_max], [x_min, y_max]])


def _floor(area: Area, height: float = 0.0) -> TilePolygons:
    return TilePolygons([np.column_stack([_corners(area, INSET), np.full(4, height)])])


def _box(area: Area, bottom: float, top: float) -> TilePolygons:
    return TilePolygons(boxes=[box_faces(_corners(area, 0.0), bottom, top)])


def _platform(area: Area, height: float) -> TilePolygons:
    """Return a floor one could stand on, with the side faces that keep one from getting there."""
    sides = box_faces(_corners(area, INSET), 0.0, height)
    return TilePolygons([sides.pop("top")], [sides])


def _scene(parts: Sequence[TilePolygons]) -> Scene:
    surfaces = [vertices for part in parts for vertices in part.surfaces]
    boxes = [box for part in parts for box in part.boxes]
    return Scene(
        {f"surface_{index}": vertices for index, vertices in enumerate(surfaces)},
        {
            f"obstacle_{index}_{face}": vertices
            for index, box in enumerate(boxes)
            for face, vertices in box.items()
        },
    )


def _near_and_far(edge: float, nearest: float = NEAR[0]) -> tuple[Area, Area]:
    near = (edge - NEAR[1], edge - nearest, -HALF_WIDTH, HALF_WIDTH)
    return near, (edge - FAR[1], edge - FAR[0], -HALF_WIDTH, HALF_WIDTH)


def _around(x: float, y: float, half: float) -> Area:
    return x - half, x + half, y - half, y + half
