"""What a course is: terrain, a way across it, and starts around its beginning."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from jaxleas.crossing.waypoints import waypoints_along
from jaxleas.footsteps import Goal
from jaxleas.terrain import Area, Scene
from jaxleas.types import GuidePath

AWAY = (0.10, 0.05, float(np.radians(5.0)))
"""How far a start may be from its place: along, across [m], heading [rad]."""
Start = tuple[float, float, float]
"""x, y [m], heading [rad]."""
STOPS = 0.25
"""Speed from which a robot stops within a few centimetres [m/s]."""
APART, PACE, ROOT_HEIGHT = 0.05, 0.5, 0.45
"""Distance between poses of a guide path [m], their speed [m/s], and their height [m]."""


@dataclass(frozen=True, eq=False)
class Course:
    """Terrain with a way across it.

    Attributes:
        name: name of the course.
        scene: terrain.
        goal: pose to reach.
        corners: x and y of the corners of the way from the origin to the goal [m]; none for a way
            straight ahead, for which no waypoints are needed.
    """

    name: str
    scene: Scene
    goal: Goal
    corners: tuple[tuple[float, float], ...] = ()

    @property
    def path(self) -> GuidePath:
        """The way to the goal, as a planner of guide paths would give it: the heading stays."""
        ends = np.array([(0.0, 0.0), *self.corners, (self.goal.x, self.goal.y)])
        lengths = np.hypot(*np.diff(ends, axis=0).T)
        way = np.concatenate([[0.0], np.cumsum(lengths)])
        along = np.linspace(0.0, way[-1], round(way[-1] / APART) + 1)
        place = np.column_stack([np.interp(along, way, ends[:, axis]) for axis in (0, 1)])
        count, time = len(along), along / PACE
        position = np.column_stack([place, np.full(count, ROOT_HEIGHT)])
        velocity = np.gradient(position, time, axis=0)
        yaw = np.full(count, self.goal.yaw)
        return GuidePath(time, position, yaw, velocity, np.ones(count, dtype=bool))

    @property
    def goals(self) -> tuple[Goal, ...]:
        """Poses to reach in turn: waypoints where the way has corners, and the goal."""
        return (*(waypoints_along(self.path) if self.corners else ()), self.goal)

    def starts(self, count: int, seed: int) -> list[Start]:
        """Return starts around the origin, drawn evenly within `AWAY`.

        Args:
            count: number of starts.
            seed: seed of the random draws.
        """
        drawn = np.random.default_rng(seed).uniform(-1.0, 1.0, (count, 3)) * np.array(AWAY)
        return [(float(x), float(y), float(yaw)) for x, y, yaw in drawn]


def stop_at(x: float, y: float = 0.0) -> Goal:
    """Return a goal at which a robot comes to rest [m]."""
    return Goal(x, y, 0.0, speed=STOPS)


def level_scene(surfaces: Mapping[str, tuple[Area, float]]) -> Scene:
    """Return level rectangles by name, each with its height [m]."""
    return Scene({name: _rectangle(area, height) for name, (area, height) in surfaces.items()})


def _rectangle(area: Area, height: float) -> Float[np.ndarray, "4 3"]:
    x_min, x_max, y_min, y_max = area
    flat = [[x_min, y_min], [x_max, y_min], [x_max, y_max], [x_min, y_max]]
    return np.column_stack([flat, np.full(4, height)])
