"""A navigator tuned for a steering method."""

import math

import numpy as np

from jaxleas.guide.places import Places
from jaxleas.guide.registry import Edges
from jaxleas.guide.roadmaps.connections import Connector
from jaxleas.guide.roadmaps.exact import refusals
from jaxleas.guide.roadmaps.navigation import Navigator, PlannerName
from jaxleas.guide.steering_method import SteeringMethod
from jaxleas.terrain import Scene


def make_navigator(
    places: Places,
    method: SteeringMethod,
    edges: Edges,
    planner: PlannerName,
    scene: Scene | None = None,
) -> Navigator:
    """Return a navigator tuned for a steering method.

    Args:
        places: places of the terrain where the robot can stand.
        method: steering method.
        edges: edges that suit the method.
        planner: rrt, prm or none.
        scene: polygons of the terrain; the exact conditions on them judge every whole path.
    """
    config, robot = places.env.config, places.env.robot
    radius = config.goal_radius if edges.radius is None else edges.radius
    # A quarter more than the time of the straight way, and time to turn around.
    straight = edges.reach / (config.desired_speed * config.limits.time_step)
    turn = math.pi / (config.limits.max_turn_rate * config.limits.time_step)
    steps = math.ceil(1.25 * straight + turn)
    connector = Connector(places, method, radius, steps)
    refused = None if scene is None else lambda path: np.logical_or(*refusals(robot, scene, path))
    return Navigator(connector, planner, edges.reach, refused)
