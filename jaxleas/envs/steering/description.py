"""The description in an exported steering policy: how to make its input and apply its command."""

from typing import Any

from jaxleas.envs.steering.config import SteeringConfig
from jaxleas.envs.steering.layout import ObservationLayout, layout_named

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
    last = layout.counts_surfaces
    return {
        "name": layout.name,
        "size": layout.size,
        "rows": list(layout.rows),
        "columns": list(layout.columns),
        "order": "velocity x, y, z in the root frame; angle to the goal; heights of the grid points"
        " relative to the root, row by row from the rearmost (first of rows), each row from right"
        " (first of columns) to left" + "; number of surfaces in the 0.8 m around the root" * last,
        "units": ["m/s", "m/s", "m/s", "rad", "m", *["1"] * last],
        "height_clip": [config.height_low, config.height_high],
    }
