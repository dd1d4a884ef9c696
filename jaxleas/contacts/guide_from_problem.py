"""From a contact problem with roots to a guide path and a scene, for planners that need both."""

import math

import numpy as np

from jaxleas.contacts.problem import ContactProblem
from jaxleas.robots import load_robot
from jaxleas.terrain import Scene, is_vertical, scale_for
from jaxleas.types import GuidePath, InputError

STEP, TURN, TIME = 0.02, 0.05, 0.2
"""Largest distance [m] and turn [rad] between two configurations, and their interval [s], as in
guide paths at the usual speed of 0.1 m/s."""
LOWER, HIGHER = 0.10, 0.03
"""At the start the root stands as high above the feet as the first root does above their middle,
but at most this far below and above the walking height of a robot with legs like Talos's [m]."""


def guide_from_problem(problem: ContactProblem) -> GuidePath:
    """Return a guide path through the roots of all steps, straight from each to the next.

    It starts above the middle between the feet's first places, heading as they do.

    Args:
        problem: problem in which each step has a root.

    Raises:
        InputError: a step has no root.
    """
    for index, step in enumerate(problem.steps):
        if step.root is None:
            raise InputError(
                f"step {index} has no root: the sampling planner follows a guide path, made of"
                " the roots of all steps; give them, or use jaxleas contacts GUIDE.npz --scene"
                " SCENE.json --planner sampling"
            )
    feet = list(problem.initial.values())
    middle = np.mean([foot.position for foot in feet], axis=0)
    roots = np.array([step.root for step in problem.steps])
    robot = load_robot(problem.robot)
    usual, leg = robot.walking_height, scale_for(robot).leg
    height = float(np.clip(roots[0, 2] - middle[2], usual - LOWER * leg, usual + HIGHER * leg))
    heading = math.atan2(*(sum(part(foot.yaw) for foot in feet) for part in (math.sin, math.cos)))
    places = np.concatenate([(middle + np.array([0.0, 0.0, height]))[None], roots])
    yaws = np.unwrap([heading, *(step.yaw for step in problem.steps)])
    ways = np.linalg.norm(np.diff(places, axis=0), axis=1)
    turns = np.abs(np.diff(yaws))
    counts = np.ceil(np.maximum(ways / STEP, turns / TURN) - 1e-6)
    corners = np.concatenate([[0.0], np.cumsum(np.maximum(counts, 1.0))])
    along = np.arange(corners[-1] + 1.0)
    position = np.stack([np.interp(along, corners, column) for column in places.T], axis=1)
    return GuidePath(
        time=along * TIME,
        position=position,
        yaw=np.interp(along, corners, yaws),
        velocity=np.gradient(position, TIME, axis=0),
        valid=np.ones(len(along), bool),
    )


def scene_of_problem(problem: ContactProblem) -> Scene:
    """Return a problem's whole surfaces as a scene; walls, on which no foot stands, as obstacles.

    Raises:
        InputError: all surfaces are walls.
    """
    whole = {name: problem.surfaces[name].vertices for name in problem.whole_surfaces}
    walls = {name: each for name, each in whole.items() if is_vertical(each)}
    surfaces = {name: each for name, each in whole.items() if name not in walls}
    if not surfaces:
        raise InputError("the problem has no surface but walls: no foot can stand on one")
    return Scene(surfaces, walls, touch=dict.fromkeys(surfaces, "feet"))
