"""Links: initial tile, transition, initial tile in a line, crossed either way (T 3.3.2)."""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from jaxleas.terrain.config import GeneratorConfig
from jaxleas.terrain.tiles import LIMITS, TileKind

LinkKind = Literal[
    "flat",
    "obstacles",
    "rubble",
    "bridge",
    "stairs_up",
    "stairs_down",
    "detour",
    "ledge",
    "gap",
    "barrier",
    "posts",
    "cliff",
    "void",
]
Area = tuple[float, float, float, float]
"""Rectangle x_min, x_max, y_min, y_max [m]."""
Cell = tuple[int, int]
"""Row, column."""
GOAL_SIZE = 1.0
"""Edge of the goal area, in the middle of the goal tile [m]."""


@dataclass(frozen=True)
class Tile:
    """One cell of an arena.

    Attributes:
        kind: kind of the tile.
        height: height of an initial tile, or of a transition's entry edge [m].
        exit_height: height of a transition's exit edge; for an initial tile the same as `height`
            [m].
        direction: direction of a transition from entry to exit, as (row, column) steps; (0, 0)
            otherwise.
        difficulty: difficulty as in `Link`; for an initial tile, the number of its boxes.
    """

    kind: TileKind = TileKind.VOID
    height: float = 0.0
    exit_height: float = 0.0
    direction: Cell = (0, 0)
    difficulty: float = 0.0


@dataclass(frozen=True)
class Link:
    """A task: from anywhere on an initial tile over a transition to the middle of the next one.

    Level ground counts too: two or three initial tiles in a row are a "flat" link, or an
    "obstacles" link when any of them carries a box (of 86 links in T fig. 3.12 these are 30).

    Attributes:
        kind: kind of the transition, or of the ground.
        difficulty: difficulty in the measure of the kind: flat 0; obstacles, the number of boxes
            on the way; rubble, the steepest rectangle over the steepest possible; bridge,
            1 - width / tile size; stairs and ledge, the climb [m]; detour, the blocked width / tile
            size; gap, its width [m]; barrier, its height [m]; posts, minus the room between them
            [m]; cliff, the height difference [m]; void 0.
        start_area: rectangle of the start tile, inset [m].
        goal_area: rectangle of the middle metre of the goal tile [m].
        start_height: height of the start tile [m].
        goal_height: height of the goal tile [m].
        direction: unit vector (x, y) from start to goal.
    """

    kind: LinkKind
    difficulty: float
    start_area: Area
    goal_area: Area
    start_height: float
    goal_height: float
    direction: tuple[float, float]


def find_links(tiles: tuple[tuple[Tile, ...], ...], config: GeneratorConfig) -> tuple[Link, ...]:
    """Return all links of a grid of tiles, each once per direction."""
    links = []
    for row, column in np.ndindex(len(tiles), len(tiles[0])):
        for down, right in ((0, 1), (1, 0)):
            for length in (2, 3):
                cells = [(row + down * step, column + right * step) for step in range(length)]
                path = [_tile_at(tiles, cell) for cell in cells]
                if _is_crossable(path, (down, right), config):
                    links.append(_link(cells, path, config))
                    links.append(_link(cells[::-1], path[::-1], config))
    return tuple(links)


def find_dead_ends(
    tiles: tuple[tuple[Tile, ...], ...], config: GeneratorConfig
) -> tuple[Link, ...]:
    """Return the tasks that cannot be done: the goal lies in the void, on a cliff or below one.

    They teach a policy to stop (T sec. 3.2.1, behaviour C).
    """
    dead_ends = []
    for row, column in np.ndindex(len(tiles), len(tiles[0])):
        start = tiles[row][column]
        for down, right in ((0, 1), (1, 0), (0, -1), (-1, 0)):
            goal = _tile_at(tiles, (row + down, column + right))
            climb = abs(goal.height - start.height)
            cliff = goal.kind.is_initial and climb > config.cliff_above
            if start.kind.is_initial and (cliff or goal.kind is TileKind.VOID):
                cells = [(row, column), (row + down, column + right)]
                kind, difficulty = ("cliff", climb) if cliff else ("void", 0.0)
                dead_ends.append(_task(cells, [start, goal], kind, difficulty, config))
    return tuple(dead_ends)


def _tile_at(tiles: tuple[tuple[Tile, ...], ...], cell: Cell) -> Tile:
    inside = 0 <= cell[0] < len(tiles) and 0 <= cell[1] < len(tiles[0])
    return tiles[cell[0]][cell[1]] if inside else Tile()


def _is_crossable(path: list[Tile], step: Cell, config: GeneratorConfig) -> bool:
    """Return whether the kinds and heights allow crossing: no cliff, no climb too high."""
    if not (path[0].kind.is_initial and path[-1].kind.is_initial):
        return False
    if all(tile.kind.is_initial for tile in path):
        heights = [tile.height for tile in path]
        return max(heights) - min(heights) < config.level_below
    middle = path[1]
    if middle.direction not in (step, (-step[0], -step[1])):
        return False
    entry, leave = path[:: 2 if middle.direction == step else -2]
    gaps = abs(entry.height - middle.height), abs(leave.height - middle.exit_height)
    limit = {
        TileKind.RUBBLE: config.level_below,
        TileKind.HOLE: config.level_below,
        TileKind.WALL: config.level_below,
        **dict.fromkeys(LIMITS, config.level_below),
        TileKind.LEDGE: config.limits.ledge[1] + 1e-9,
        TileKind.BRIDGE: config.bridge_below,
        # the largest climb that the generator may draw still is a link
        TileKind.STAIRS: max(config.stairs_below, config.stairs.climb[1]) + 1e-9,
    }[middle.kind]
    return max(gaps) < 1e-6 and abs(middle.exit_height - middle.height) < limit


def _link(cells: list[Cell], path: list[Tile], config: GeneratorConfig) -> Link:
    return _task(cells, path, *_kind_and_difficulty(path), config)


def _task(
    cells: list[Cell],
    path: list[Tile],
    kind: LinkKind,
    difficulty: float,
    config: GeneratorConfig,
) -> Link:
    start, goal = cells[0], cells[-1]
    return Link(
        kind=kind,
        difficulty=difficulty,
        start_area=_square(start, config, 0.5 * config.tile_size - config.inset),
        goal_area=_square(goal, config, 0.5 * GOAL_SIZE),
        start_height=path[0].height,
        goal_height=path[-1].height,
        direction=(float(np.sign(goal[1] - start[1])), float(np.sign(goal[0] - start[0]))),
    )


def _kind_and_difficulty(path: list[Tile]) -> tuple[LinkKind, float]:
    if all(tile.kind.is_initial for tile in path):
        boxes = sum(tile.difficulty for tile in path)
        return ("obstacles" if boxes > 0.0 else "flat"), boxes
    difficulty = path[1].difficulty
    if path[1].kind is TileKind.STAIRS:
        return ("stairs_up" if path[-1].height > path[0].height else "stairs_down"), difficulty
    kinds: dict[TileKind, LinkKind] = {
        TileKind.RUBBLE: "rubble",
        TileKind.BRIDGE: "bridge",
        TileKind.HOLE: "detour",
        TileKind.WALL: "detour",
        TileKind.LEDGE: "ledge",
        TileKind.GAP: "gap",
        TileKind.BARRIER: "barrier",
        TileKind.POSTS: "posts",
    }
    return kinds[path[1].kind], difficulty


def _square(cell: Cell, config: GeneratorConfig, half: float) -> Area:
    x, y = ((index + 0.5) * config.tile_size for index in (cell[1], cell[0]))
    return x - half, x + half, y - half, y + half
