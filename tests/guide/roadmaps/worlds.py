"""Level ground with a trench across it, and robots that walk there."""

import numpy as np

from jaxleas.envs.steering.config import SteeringConfig
from jaxleas.envs.steering.env import SteeringEnv
from jaxleas.guide import rb_kino
from jaxleas.guide.places import Places
from jaxleas.guide.roadmaps.connections import Connector
from jaxleas.guide.roadmaps.navigation import Navigator
from jaxleas.terrain import HeightMap

ENV = SteeringEnv(SteeringConfig())
LIMITS = ENV.config.limits


def trench_map(end: float = 1.2) -> HeightMap:
    """6 x 6 m of floor; no ground where |x| < 0.5 and y < end."""
    cells = np.arange(-3.0, 3.01, 0.1)
    heights = np.zeros((len(cells), len(cells)), np.float32)
    heights[np.ix_(cells < end, np.abs(cells) < 0.5)] = np.nan
    return HeightMap(heights, 0.1, (-3.0, -3.0))


def kino_navigator(terrain: HeightMap, planner="rrt") -> Navigator:
    places = Places(ENV, terrain)
    return Navigator(Connector(places, rb_kino(LIMITS, 0.1), 0.01, 150), planner, 1.5)
