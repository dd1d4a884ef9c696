"""All scenarios by name, and their scenes with the task as named areas."""

import difflib
from collections.abc import Callable, Mapping
from types import MappingProxyType

import numpy as np

from jaxleas.terrain.links import Area
from jaxleas.terrain.scale import PUBLISHED, Scale
from jaxleas.terrain.scenarios.courses import circuit, long_course, rotation
from jaxleas.terrain.scenarios.detours import dead_end, hole, hole_rim, wall
from jaxleas.terrain.scenarios.limits import LIMITS
from jaxleas.terrain.scenarios.scenario import Scenario, around
from jaxleas.terrain.scenarios.transitions import (
    EVALUATION_KINDS,
    bridge_ahead,
    evaluation_terrain,
    transition,
)
from jaxleas.terrain.scene import Scene
from jaxleas.types import InputError

SCENARIOS: Mapping[str, Callable[[int], Scenario]] = MappingProxyType(
    {
        "rubble": lambda seed: transition("rubble", seed),
        "bridge": lambda seed: transition("bridge", seed),
        "bridge_ahead": bridge_ahead,
        "stairs_up": lambda seed: transition("stairs_up", seed),
        "stairs_down": lambda seed: transition("stairs_down", seed),
        "hole": hole,
        "hole_rim": hole_rim,
        "wall": wall,
        "rotation": rotation,
        "long_course": long_course,
        "circuit": circuit,
        "dead_end_void": lambda seed: dead_end("void", seed),
        "dead_end_wall": lambda seed: dead_end("wall", seed),
        "dead_end_platform": lambda seed: dead_end("platform", seed),
        **LIMITS,
        **{
            f"evaluation_terrain_{kind}": lambda seed, index=index: evaluation_terrain(seed)[index]
            for index, kind in enumerate(EVALUATION_KINDS)
        },
    }
)
"""The sources draw most of these terrains without dimensions; each docstring says what is published
and what is chosen here. All are walked in the direction of +x (the circuit begins so), and each is
always the same for the same name and seed."""


def make_scenario(name: str, seed: int, scale: Scale = PUBLISHED) -> Scenario:
    """Return a scenario by its name.

    Args:
        name: name of the scenario, one of `SCENARIOS`.
        seed: seed of its random lengths.
        scale: scale of the robot that walks there; all lengths grow with its leg.

    Raises:
        InputError: there is no scenario of that name.
    """
    if name not in SCENARIOS:
        close = difflib.get_close_matches(name, SCENARIOS, n=1, cutoff=0.5)
        hint = f"did you mean {close[0]!r}? There are" if close else "there are"
        raise InputError(f"no scenario is called {name!r}; {hint} {', '.join(SCENARIOS)}")
    return SCENARIOS[name](seed).scaled(scale.leg)


def scene_with_areas(scenario: Scenario) -> Scene:
    """Return a scenario's scene with its task as named areas: starts, goal, waypoints.

    `start` (or `start_near` and `start_far`), `goal`, and `waypoint_1`, `waypoint_2`, ... as
    squares of 0.2 m around each.
    """
    starts = scenario.start_areas
    names = ("start",) if len(starts) == 1 else ("start_near", "start_far")
    areas: dict[str, Area] = dict(zip(names, starts, strict=True))
    if not scenario.waypoints:
        areas["goal"] = scenario.goal_area
    for number, point in enumerate(scenario.waypoints, start=1):
        areas[f"waypoint_{number}"] = around(*point, 0.1)
    scene = scenario.scene
    corners = {name: _corners(area) for name, area in areas.items()}
    return Scene(scene.surfaces, scene.obstacles, corners)


def _corners(area: Area) -> np.ndarray:
    x_min, x_max, y_min, y_max = area
    return np.array([[x_min, y_min], [x_max, y_min], [x_max, y_max], [x_min, y_max]])
