"""The steering task as plain numbers, read from a file."""

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

AREAS = ("start_area", "near_area", "goal_area", "arena_area")
ARRAYS = ("heights", "origin", "map_index", *AREAS, "share")


@dataclass(frozen=True)
class Task:
    """Terrain, links and constants of the task.

    Attributes:
        heights: heights of every map, float32 [maps, rows, columns]; far below without ground.
        origin: centre x, y of each map's first cell [m].
        map_index: map of each link.
        start_area: bounds x_min, x_max, y_min, y_max of each link's start area [m].
        near_area: bounds of the part of the start area next to the obstacle, likewise.
        goal_area: bounds of each link's goal area, likewise.
        arena_area: bounds of each link's arena, likewise.
        share: cumulative share of the starts.
        constants: all other values: layout, limits, weights, robot; see `write_task`.
    """

    heights: np.ndarray
    origin: np.ndarray
    map_index: np.ndarray
    start_area: np.ndarray
    near_area: np.ndarray
    goal_area: np.ndarray
    arena_area: np.ndarray
    share: np.ndarray
    constants: dict[str, Any]


def read_task(path: str | Path) -> Task:
    """Read a task file."""
    with np.load(path, allow_pickle=False) as archive:
        arrays = {name: archive[name] for name in ARRAYS}
        return Task(**arrays, constants=json.loads(str(archive["constants"])))
