"""What an exported policy says about itself: the metadata of its ONNX file."""

import json
from collections.abc import Mapping
from typing import Any

from pydantic import ValidationError

from jaxleas.envs.steering import FORMAT, SteeringConfig, describe_observation, layout_named
from jaxleas.files import parse_json
from jaxleas.types import InputError

INPUT, OUTPUT = "observation", "command"


def read_config(path: object, metadata: Mapping[str, str]) -> SteeringConfig:
    """Return the task that the metadata describes, checked against this version's layouts.

    Args:
        path: path of the file, for messages.
        metadata: metadata of the file.

    Raises:
        InputError: the file is not a policy that `jaxleas export` wrote, or its format or layout is
            another one.
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
    expected = json.loads(json.dumps(describe_observation(layout, config)))
    for key in expected:
        if observation.get(key) != expected[key] or config.observation != name:
            raise InputError(
                f"{path} expects another observation layout than this version's {name}: its"
                f" {key} is {_short(observation.get(key))}, not {_short(expected[key])}"
            )
    return config


def _short(value: Any) -> str:
    text = json.dumps(value)
    return text if len(text) <= 60 else f"{text[:57]}..."
