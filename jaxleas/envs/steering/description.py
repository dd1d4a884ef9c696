"""The description in an exported steering policy: how to make its input and apply its command."""

from typing import Any

from jaxleas.conditions import STANDARD, Collision, StrictReachability, union_of_points
from jaxleas.envs.steering.config import SteeringConfig
from jaxleas.envs.steering.feelers import MOST_FELT, points_to_feel
from jaxleas.envs.steering.guard import guard_terms
from jaxleas.envs.steering.layout import ObservationLayout, layout_named
from jaxleas.envs.steering.sight import sampled_points
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
    described = {
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
    if config.guard.enabled:
        described["guard"] = describe_guard(config)
    return described


def describe_guard(config: SteeringConfig) -> dict[str, Any]:
    """Return what the guard asks of each configuration on the way to rest, as plain JSON values."""
    robot = load_robot(config.robot)
    both = guard_terms(config, robot, sampled_points(config, robot))
    points = union_of_points([each.points_in_root for terms in both for each in terms])
    described: dict[str, Any] = {"points": points.tolist()}
    for name, (reach, free) in zip(("valid", "spared"), both, strict=True):
        described[name] = {
            "reach": [list(each) for each in reach.read_from(points).intervals],
            "free": [list(each) for each in free.read_from(points).bottoms],
        }
    return described | {
        "margin": "of valid and of spared, the least of: the largest min(height - low, high -"
        " height) over its reach [point, low, high], and bottom - height over its free [point,"
        " bottom]; points in the root frame [m], heights relative to the root, -10000 without"
        " ground",
        "rule": "a command is obeyed if, where the root arrives and wherever it would be if it then"
        " braked to rest by max_acceleration, the margin of valid is 0 or more, and that of spared"
        " 0 or more or no less than it is now; else the same without its turn rate; else the"
        " velocity changes towards (0, 0, that commanded upwards) by at most max_acceleration,"
        " without a turn; else the root brakes",
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
