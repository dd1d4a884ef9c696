"""Named terrains for evaluation (T 3.4.2, 4.3, 5.2 and their figures; I sec. IV)."""

from jaxleas.terrain.scenarios.catalogue import SCENARIOS, make_scenario, scene_with_areas
from jaxleas.terrain.scenarios.courses import circuit, long_course, rotation
from jaxleas.terrain.scenarios.detours import DeadEndKind, dead_end, hole, hole_rim, wall
from jaxleas.terrain.scenarios.scenario import Scenario
from jaxleas.terrain.scenarios.transitions import (
    TransitionKind,
    bridge_ahead,
    evaluation_terrain,
    transition,
)

__all__ = [
    "SCENARIOS",
    "DeadEndKind",
    "Scenario",
    "TransitionKind",
    "bridge_ahead",
    "circuit",
    "dead_end",
    "evaluation_terrain",
    "hole",
    "hole_rim",
    "long_course",
    "make_scenario",
    "rotation",
    "scene_with_areas",
    "transition",
    "wall",
]
