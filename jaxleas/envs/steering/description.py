"""The description in an exported steering policy: how to make its input and apply its command."""

from typing import Any

from jaxleas.conditions import STANDARD, Collision, StrictReachability
from jaxleas.envs.steering.config import SteeringConfig
from jaxleas.envs.steering.feelers import MOST_FELT, points_to_feel
from jaxleas.envs.steering.layout import ObservationLayout, layout_named
from jaxleas.robots import load_robot

FORMAT = 1
SOURCE = (
    "LEAS steering policy: J. Chemin, thesis NNT 2022ISAT0046, chapter 3;"
    " Chemin et al., Learning to steer a locomotion contact planner, ICRA 2021"
)
COMMAND_ORDER = ["acceleration_x", "acceleration_y", "acceleration_z", "turn_rate"]
COMMAND_UNITS = ["m/s^2", "m/s^2", "m/s^2", "rad/s"]


def describe_steering(config: SteeringConfig) -> dict[str, Any]:
    """Return what a caller must know to use a policy, as plain JSON values."""
    layout = layout_named(config.observation)
    limits = config.limits
    return {
        "format": FORMAT,
        "task": config.task,
        "observation": describe_observation(layout, config),
        "command": {
            "order": COMMAND_ORDER,
            "units": COMMAND_UNITS,
            "frame": "root: x ahead, y left, z up",
            "max_acceleration": limits.max_acceleration,
            "max_turn_rate": limits.max_turn_rate,
            "max_speed": limits.max_speed,
            "time_step": limits.time_step,
            "integration": "position += velocity T; then velocity += acceleration T, its norm"
            " at most max_speed; then yaw += turn_rate T",
        },
        "robot": config.robot,
        "steering_config": config.model_dump(mode="json"),
        "source": SOURCE,
    }


def describe_observation(layout: ObservationLayout, config: SteeringConfig) -> dict[str, Any]:
    """Return the order, units and places of an observation's values, as plain JSON values."""
    last, feelers = layout.counts_surfaces, bool(layout.feelers)
    described = {
        "name": layout.name,
        "size": layout.size,
        "rows": list(layout.rows),
        "columns": list(layout.columns),
        "order": "velocity x, y, z in the root frame; angle to the goal; heights of the grid points"
        " relative to the root, row by row from the rearmost (first of rows), each row from right"
        " (first of columns) to left"
        + "; heights at the x of profile, y = 0" * bool(layout.profile)
        + "; number of surfaces in the 0.8 m around the root" * last
        + "; felt margins, one for each of feelers.moves" * feelers,
        "units": ["m/s", "m/s", "m/s", "rad", "m", *["1"] * last, *["m"] * feelers],
        "height_clip": [config.height_low, config.height_high],
    }
    if layout.profile:
        described["profile"] = list(layout.profile)
    if feelers:
        described["feelers"] = describe_feelers(layout, config)
    return described


def describe_feelers(layout: ObservationLayout, config: SteeringConfig) -> dict[str, Any]:
    """Return how the felt margins are computed, as plain JSON values."""
    robot, reach, free, every = load_robot(config.robot), [], [], []
    for move in layout.feelers:
        points = points_to_feel(robot, move)
        every.append(points.tolist())
        asked = StrictReachability(robot, points).read_from(points).intervals
        reach.append([list(each) for each in asked])
        free.append([list(each) for each in Collision(robot, points).read_from(points).bottoms])
    described = {
        "moves": [list(move) for move in layout.feelers],
        "moves_are": "how far the root is moved ahead, to the left [m] and turned left [rad]",
        "clip": [-MOST_FELT, MOST_FELT],
        "conditions": [str(each) for each in config.conditions],
    }
    if config.conditions == STANDARD:
        # What a caller without this package needs; other conditions are code.
        described |= {
            "points": every,
            "reach": reach,
            "free": free,
            "margin": "for each move, its points in the frame of the moved root [m]; the least of:"
            " the largest min(height - low, high - height) over its reach [point, low, high], and"
            " bottom - height over its free [point, bottom]; heights relative to the root, -10000"
            " where there is no ground",
        }
    return described
