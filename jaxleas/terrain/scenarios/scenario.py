"""A terrain with a task, and the parts of which named terrains are built."""

import zlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from jaxleas.terrain.config import GeneratorConfig
from jaxleas.terrain.limit import Limit
from jaxleas.terrain.links import Area
from jaxleas.terrain.polygons import box_faces
from jaxleas.terrain.scene import Scene
from jaxleas.terrain.tiles import TileFrame, TilePolygons

CONFIG = GeneratorConfig()
SIZE, INSET = CONFIG.tile_size, CONFIG.inset
NEAR, FAR, HALF_WIDTH = (0.25, 0.9), (0.9, 1.75), 0.7
"""Distances of starts before the first edge ahead, and to either side of the middle [m]."""


@dataclass(frozen=True)
class Scenario:
    """A terrain with a task.

    Attributes:
        name: name of the scenario, such as "bridge".
        scene: polygons of the terrain.
        start_areas: rectangles (x_min, x_max, y_min, y_max) [m]: near and far, or only one.
        goal_area: rectangle of the goal [m].
        waypoints: points (x, y) to reach in order [m]; only for courses and circuits.
        crossing: whether the goal can be reached; if not, the robot must stop and stay valid.
        limit: obstacle that decides whether the goal can be reached, which depends on the robot.
    """

    name: str
    scene: Scene
    start_areas: tuple[Area, ...]
    goal_area: Area
    waypoints: tuple[tuple[float, float], ...] = ()
    crossing: bool = True
    limit: Limit | None = None

    def scaled(self, factor: float) -> "Scenario":
        """Return the same terrain and task with every length multiplied; 1 returns this one.

        Args:
            factor: factor, such as `Scale.leg` for a robot [1].
        """
        if factor == 1.0:
            return self
        scene = self.scene
        return replace(
            self,
            scene=replace(
                scene,
                surfaces=_multiplied(scene.surfaces, factor),
                obstacles=_multiplied(scene.obstacles, factor),
            ),
            start_areas=tuple(_area(each, factor) for each in self.start_areas),
            goal_area=_area(self.goal_area, factor),
            waypoints=tuple((factor * x, factor * y) for x, y in self.waypoints),
            limit=None if self.limit is None else self.limit.scaled(factor),
        )


def random_stream(name: str, seed: int) -> np.random.Generator:
    """Return the generator of a scenario's random numbers, independent of all others."""
    return np.random.default_rng([zlib.crc32(name.encode()), seed])


def tile_frame(column: int, row: int = 0, direction: tuple[float, float] = (1.0, 0.0)) -> TileFrame:
    """Return the frame of a tile in a grid whose row 0 lies along the x axis."""
    centre = ((column + 0.5) * SIZE, row * SIZE)
    entry = (centre[0] - 0.5 * SIZE * direction[0], centre[1] - 0.5 * SIZE * direction[1])
    return TileFrame(entry, direction, SIZE, INSET)


def floor(area: Area, height: float = 0.0) -> TilePolygons:
    """Return one horizontal rectangle."""
    return TilePolygons([np.column_stack([_corners(area, INSET), np.full(4, height)])])


def box(area: Area, bottom: float, top: float) -> TilePolygons:
    """Return an upright obstacle."""
    return TilePolygons(boxes=[box_faces(_corners(area, 0.0), bottom, top)])


def platform(area: Area, height: float) -> TilePolygons:
    """Return a raised floor, with side faces that keep a robot from walking onto it."""
    sides = box_faces(_corners(area, INSET), 0.0, height)
    return TilePolygons([sides.pop("top")], [sides])


def compose(parts: Sequence[TilePolygons]) -> Scene:
    """Return the scene of all parts, surfaces and boxes numbered in their order."""
    surfaces = [vertices for part in parts for vertices in part.surfaces]
    boxes = [faces for part in parts for faces in part.boxes]
    return Scene(
        {f"surface_{index}": vertices for index, vertices in enumerate(surfaces)},
        {
            f"obstacle_{index}_{face}": vertices
            for index, faces in enumerate(boxes)
            for face, vertices in faces.items()
        },
    )


def near_and_far(edge: float, nearest: float = NEAR[0]) -> tuple[Area, Area]:
    """Return the two start areas before an edge at x = `edge` [m]."""
    near = (edge - NEAR[1], edge - nearest, -HALF_WIDTH, HALF_WIDTH)
    return near, (edge - FAR[1], edge - FAR[0], -HALF_WIDTH, HALF_WIDTH)


def around(x: float, y: float, half: float) -> Area:
    """Return the square of edge 2 x `half` around a point [m]."""
    return x - half, x + half, y - half, y + half


def _multiplied(polygons: Mapping[str, np.ndarray], factor: float) -> dict[str, np.ndarray]:
    return {name: factor * vertices for name, vertices in polygons.items()}


def _area(area: Area, factor: float) -> Area:
    x_min, x_max, y_min, y_max = area
    return factor * x_min, factor * x_max, factor * y_min, factor * y_max


def _corners(area: Area, inset: float) -> np.ndarray:
    x_min, x_max, y_min, y_max = area
    x_min, x_max, y_min, y_max = x_min + inset, x_max - inset, y_min + inset, y_max - inset
    return np.array([[x_min, y_min], [x_max, y_min], [x_max, y_max], [x_min, y_max]])
