"""The random arena: a tree of initial and transition tiles fills a grid (T 3.3.2)."""

from dataclasses import dataclass
from functools import partial

import numpy as np

from jaxleas.terrain.config import GeneratorConfig
from jaxleas.terrain.links import Cell, Link, Tile, find_dead_ends, find_links
from jaxleas.terrain.scene import Scene
from jaxleas.terrain.tiles import (
    LIMITS,
    TileFrame,
    TileKind,
    TilePolygons,
    bridge_tile,
    flat_tile,
    hole_tile,
    limit_tile,
    obstacle_tile,
    rubble_tile,
    stairs_tile,
    wall_tile,
)

DIRECTIONS: tuple[Cell, ...] = ((0, 1), (1, 0), (0, -1), (-1, 0))


@dataclass(frozen=True)
class Arena:
    """A random terrain with tasks.

    Attributes:
        scene: polygons of the terrain; the corner of tile (0, 0) is the world's origin.
        tiles: kind and heights of each cell, [row = y, column = x].
        links: tasks, with each undirected link twice.
        dead_ends: tasks that cannot be done, from every initial tile.
    """

    scene: Scene
    tiles: tuple[tuple[Tile, ...], ...]
    links: tuple[Link, ...]
    dead_ends: tuple[Link, ...] = ()


def generate_arena(config: GeneratorConfig, seed: int) -> Arena:
    """Return the arena of a seed: always the same one for the same configuration."""
    builder = _Builder(config, np.random.default_rng(seed))
    builder.fill()
    tiles = tuple(tuple(row) for row in builder.tiles)
    return Arena(
        scene=Scene(builder.surfaces, builder.obstacles),
        tiles=tiles,
        links=find_links(tiles, config),
        dead_ends=find_dead_ends(tiles, config),
    )


class _Builder:
    """Builder of the tree of tiles: it extends one random edge of the frontier at a time."""

    def __init__(self, config: GeneratorConfig, rng: np.random.Generator):
        self.config, self.rng = config, rng
        self.tiles = [[Tile() for _ in range(config.columns)] for _ in range(config.rows)]
        self.surfaces: dict[str, np.ndarray] = {}
        self.obstacles: dict[str, np.ndarray] = {}
        self.frontier: list[tuple[Cell, Cell]] = []

    def fill(self) -> None:
        first = (
            int(self.rng.integers(self.config.rows)),
            int(self.rng.integers(self.config.columns)),
        )
        self.place_initial(first, 0.0)
        while self.frontier:
            index = int(self.rng.integers(len(self.frontier)))
            self.frontier[index], self.frontier[-1] = self.frontier[-1], self.frontier[index]
            self.grow(*self.frontier.pop())

    def grow(self, cell: Cell, direction: Cell) -> None:
        """Fill the neighbour of an initial tile in a direction, and the cell after a transition."""
        near = (cell[0] + direction[0], cell[1] + direction[1])
        far = (near[0] + direction[0], near[1] + direction[1])
        if not self.is_empty(near):
            return
        height = self.tiles[cell[0]][cell[1]].height
        if self.rng.random() >= self.config.transition_probability:
            self.place_initial(near, height)
        elif self.is_empty(far):
            kind, exit_height = self.draw_transition(height)
            self.place_transition(near, direction, kind, (height, exit_height))
            self.place_initial(far, exit_height)
        elif self.is_inside(far) and self.tiles[far[0]][far[1]].kind.is_initial:
            self.join(near, direction, height, self.tiles[far[0]][far[1]].height)
        elif self.rng.random() < self.config.dead_end_probability:
            kind, exit_height = self.draw_transition(height)
            self.place_transition(near, direction, kind, (height, exit_height))
        else:
            self.place_initial(near, height)

    def draw_transition(self, height: float) -> tuple[TileKind, float]:
        """Return a transition into an empty cell, and the height that it leads to."""
        config, rng = self.config, self.rng
        if config.detour_probability > 0.0 and rng.random() < config.detour_probability:
            return (TileKind.HOLE if rng.random() < 0.5 else TileKind.WALL), height
        if config.limit_probability > 0.0 and rng.random() < config.limit_probability:
            kind = LIMITS[int(rng.integers(len(LIMITS)))]
            rise = rng.choice([-1, 1]) * rng.uniform(*config.limits.ledge)
            return kind, height + rise * (kind is TileKind.LEDGE)
        draw = rng.random()
        if draw < config.stairs_probability:
            return TileKind.STAIRS, height + rng.choice([-1, 1]) * rng.uniform(*config.stairs.climb)
        if draw < config.stairs_probability + config.bridge_probability:
            sloped = rng.random() < config.bridge.sloped_probability
            rise = rng.uniform(-config.bridge.rise, config.bridge.rise) if sloped else 0.0
            return TileKind.BRIDGE, height + rise
        return TileKind.RUBBLE, height

    def join(self, near: Cell, direction: Cell, height: float, far_height: float) -> None:
        """Join two initial tiles by what their height difference allows, or leave a cliff."""
        difference, config = abs(far_height - height), self.config
        if difference >= config.stairs_below:
            self.place_initial(near, height)
            return
        bridge = difference < config.bridge_only_below or (
            difference < config.bridge_below and self.rng.random() < 0.5
        )
        kind = TileKind.BRIDGE if bridge else TileKind.STAIRS
        self.place_transition(near, direction, kind, (height, far_height))

    def place_initial(self, cell: Cell, height: float) -> None:
        frame = self.frame(cell, (0, 1))
        if self.rng.random() < self.config.obstacles.probability:
            kind, polygons = TileKind.OBSTACLES, obstacle_tile(frame, height, self.config, self.rng)
        else:
            kind, polygons = TileKind.FLAT, flat_tile(frame, height)
        self.add(cell, polygons)
        self.tiles[cell[0]][cell[1]] = Tile(kind, height, height, difficulty=polygons.difficulty)
        self.frontier.extend((cell, direction) for direction in DIRECTIONS)

    def place_transition(
        self, cell: Cell, direction: Cell, kind: TileKind, heights: tuple[float, float]
    ) -> None:
        make = {
            TileKind.RUBBLE: rubble_tile,
            TileKind.BRIDGE: bridge_tile,
            TileKind.STAIRS: stairs_tile,
            TileKind.HOLE: hole_tile,
            TileKind.WALL: wall_tile,
            **{each: partial(limit_tile, kind=each) for each in LIMITS},
        }[kind]
        polygons = make(self.frame(cell, direction), heights, self.config, self.rng)
        self.add(cell, polygons)
        self.tiles[cell[0]][cell[1]] = Tile(kind, *heights, direction, polygons.difficulty)

    def frame(self, cell: Cell, direction: Cell) -> TileFrame:
        size = self.config.tile_size
        along = (float(direction[1]), float(direction[0]))
        centre = ((cell[1] + 0.5) * size, (cell[0] + 0.5) * size)
        entry = (centre[0] - 0.5 * size * along[0], centre[1] - 0.5 * size * along[1])
        return TileFrame(entry, along, size, self.config.inset)

    def add(self, cell: Cell, polygons: TilePolygons) -> None:
        prefix = f"tile_{cell[0]}_{cell[1]}"
        for index, vertices in enumerate(polygons.surfaces):
            self.surfaces[f"{prefix}_{index}"] = vertices
        for box in polygons.boxes:
            name = f"obstacle_{len(self.obstacles) // 5}"
            self.obstacles.update({f"{name}_{face}": vertices for face, vertices in box.items()})

    def is_inside(self, cell: Cell) -> bool:
        return 0 <= cell[0] < self.config.rows and 0 <= cell[1] < self.config.columns

    def is_empty(self, cell: Cell) -> bool:
        return self.is_inside(cell) and self.tiles[cell[0]][cell[1]].kind is TileKind.VOID
