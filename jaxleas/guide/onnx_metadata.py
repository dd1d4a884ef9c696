"""What an exported policy says about itself: the metadata of its ONNX file."""

import json
from collections.abc import Mapping
from typing import Any

from pydantic import ValidationError

from jaxleas.envs.steering.config import SteeringConfig
from jaxleas.envs.steering.layout import ObservationLayout, layout_named
from jaxleas.files import parse_json
from jaxleas.types import InputError

FORMAT = 1
INPUT, OUTPUT = "observation", "command"

COMMAND_ORDER = ["acceleration_x", "acceleration_y", "acceleration_z", "turn_rate"]
COMMAND_UNITS = ["m/s^2", "m/s^2", "m/s^2", "rad/s"]


def describe(config: SteeringConfig) -> dict[str, str]:
    """Return what a driver must know to feed a policy and to obey it, each value a JSON text."""
    layout = layout_named(config.observation)
    limits = config.limits
    return {
        "format": json.dumps(FORMAT),
        "observation": json.dumps(_observation(layout, config)),
        "command": json.dumps(
            {
                "order": COMMAND_ORDER,
                "units": COMMAND_UNITS,
                "frame": "root: x ahead, y left, z up",
                "max_acceleration": limits.max_acceleration,
                "max_turn_rate": limits.max_turn_rate,
                "max_speed": limits.max_speed,
                "time_step": limits.time_step,
                "integration": "position += velocity T; then velocity += acceleration T, its norm"
                " at most max_speed; then yaw += turn_rate T",
            }
        ),
        "robot": json.dumps(config.robot),
        "steering_config": json.dumps(config.model_dump(mode="json")),
    }


def read_config(path: object, metadata: Mapping[str, str]) -> SteeringConfig:
    """Return the task that a file's metadata describes, checked against this version's layouts.

    Args:
        path: of the file, for messages.
        metadata: of the file.

    Raises:
        InputError: the file is no policy of ours, of another format, or of another layout.
    """
    if not {"format", "observation", "steering_config"} <= metadata.keys():
        raise InputError(
            f"{path} is an ONNX file but not a steering policy: its metadata lacks the observation"
            " layout; `jaxleas export RUN` writes one"
        )
    try:
        form, observation, stated = (
            parse_json(metadata[key], f"{path}: {key} of its metadata")
            for key in ("format", "observation", "steering_config")
        )
        name = observation["name"]
    except (ValueError, TypeError, KeyError) as error:
        raise InputError(f"{path}: its metadata is not a steering policy's: {error}") from error
    if form != FORMAT:
        raise InputError(f"{path} is a policy of format {form!r}; this version reads {FORMAT}")
    try:
        layout = layout_named(str(name))
    except InputError as error:
        raise InputError(f"{path} expects another observation layout: {error}") from error
    try:
        config = SteeringConfig.model_validate(stated)
    except ValidationError as error:
        first = error.errors()[0]
        key = ".".join(map(str, ("steering_config", *first["loc"])))
        raise InputError(f"{path}: its metadata {key} is not usable: {first['msg']}") from error
    expected = json.loads(json.dumps(_observation(layout, config)))
    for key in ("name", "size", "rows", "columns", "order", "units", "height_clip"):
        if observation.get(key) != expected[key] or config.observation != name:
            raise InputError(
                f"{path} expects another observation layout than this version's {name}: its"
                f" {key} is {_short(observation.get(key))}, not {_short(expected[key])}"
            )
    return config


def _observation(layout: ObservationLayout, config: SteeringConfig) -> dict[str, Any]:
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


def _short(value: Any) -> str:
    text = json.dumps(value)
    return text if len(text) <= 60 else f"{text[:57]}..."
