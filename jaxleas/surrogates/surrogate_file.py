"""Files of surrogates: plain arrays and one JSON text, like policies (docs/files.md)."""

import json
from dataclasses import fields
from pathlib import Path
from typing import Any

import jax.numpy as jnp
import numpy as np
from pydantic import ValidationError

from jaxleas.envs.steering import SteeringConfig
from jaxleas.files import parse_json, read_npz, write_npz
from jaxleas.surrogates.network import Weights
from jaxleas.surrogates.surrogate import Identity, Surrogate
from jaxleas.types import InputError

FORMAT = 2
MAX_BYTES = 2**28  # a surrogate of a quarter of a gigabyte is a mistake
_WEIGHTS = tuple(field.name for field in fields(Weights))  # type: ignore[arg-type]


def write_surrogate(path: str | Path, surrogate: Surrogate) -> None:
    """Write a surrogate's file, whole or not at all."""
    metadata = {
        "format": FORMAT,
        "identity": surrogate.identity.model_dump(mode="json"),
        "report": surrogate.report or {},
    }
    write_npz(
        path,
        metadata=np.array(json.dumps(metadata)),
        scale=np.asarray(surrogate.scale),
        shift=np.asarray(surrogate.shift),
        **{name: np.asarray(getattr(surrogate.weights, name)) for name in _WEIGHTS},
    )


def read_surrogate(path: str | Path) -> Surrogate:
    """Read a surrogate's file.

    Raises:
        InputError: the file is not a surrogate, is damaged, or has another format.
    """
    required = ("metadata", "scale", "shift", *_WEIGHTS)
    arrays = read_npz(path, required, max_bytes=MAX_BYTES)
    try:
        metadata = parse_json(str(arrays["metadata"]), f"{path}: its metadata")
        if metadata["format"] != FORMAT:
            raise InputError(
                f"{path} is a surrogate of format {metadata['format']}; this version reads"
                f" {FORMAT}: fit it again from its labels"
            )
        identity = Identity.model_validate(metadata["identity"])
        if identity.keep_every < 1:
            raise ValueError("keep_every must be at least 1")
        report = metadata.get("report", {})
        if not isinstance(report, dict):
            raise ValueError("report must be an object")
    except ValidationError as error:
        first = error.errors()[0]
        key = ".".join(map(str, first["loc"]))
        raise InputError(f"{path}: identity.{key} of its metadata: {first['msg']}") from error
    except (KeyError, TypeError, ValueError) as error:
        raise InputError(f"{path}: its metadata is not a surrogate's: {error!r}") from error
    _check(path, arrays, identity)
    return Surrogate(
        weights=Weights(**{name: jnp.asarray(arrays[name]) for name in _WEIGHTS}),
        scale=jnp.asarray(arrays["scale"]),
        shift=jnp.asarray(arrays["shift"]),
        identity=identity,
        report=report or (),
    )


def require_fit(
    surrogate: Surrogate,
    env: SteeringConfig,
    planner: str | None = None,
    parameters: dict[str, Any] | None = None,
    where: str = "the surrogate",
) -> None:
    """Refuse a surrogate that does not fit an environment or a planner.

    Args:
        surrogate: surrogate to check.
        env: configuration of the environment in which the surrogate will judge.
        planner: required planner; None accepts any.
        parameters: required parameters of the planner; None accepts any.
        where: name of the surrogate in messages.

    Raises:
        InputError: the surrogate does not fit; the message says what differs.
    """
    identity = surrogate.identity
    wanted: dict[str, Any] = {
        "robot": env.robot,
        "observation": env.observation,
        "height_low": env.height_low,
        "height_high": env.height_high,
    }
    if planner is not None:
        wanted["planner"] = planner
    for name, value in wanted.items():
        if (found := getattr(identity, name)) != value:
            raise InputError(
                f"{where} stands in for {name} = {found}, not {value}: fit one to labels of that"
            )
    if parameters is not None and identity.parameters != parameters:
        differ = sorted(
            name
            for name in identity.parameters.keys() | parameters.keys()
            if identity.parameters.get(name) != parameters.get(name)
        )
        found = ", ".join(f"{name} = {identity.parameters.get(name)}" for name in differ)
        asked = ", ".join(f"{name} = {parameters.get(name)}" for name in differ)
        raise InputError(
            f"{where} stands in for the {identity.planner} planner with {found}, not with {asked}:"
            " fit one to labels of that"
        )


def _check(path: str | Path, arrays: dict[str, np.ndarray], identity: Identity) -> None:
    """Refuse arrays that do not make a network for an identity."""
    code, hidden = arrays["encoder_bias"].size, arrays["head"].size
    expected = {
        "scale": (),
        "shift": (),
        "encoder": (identity.inputs, code),
        "encoder_bias": (code,),
        "gates": (code + hidden, 2 * hidden),
        "gates_bias": (2 * hidden,),
        "candidate": (code + hidden, hidden),
        "candidate_bias": (hidden,),
        "head": (hidden,),
        "head_bias": (),
    }
    for name, shape in expected.items():
        array = arrays[name]
        if array.shape != shape:
            raise InputError(
                f"{path}: {name} of shape {array.shape} where {shape} is needed for"
                f" {identity.observation}"
            )
        if not np.issubdtype(array.dtype, np.floating) or not np.isfinite(array).all():
            raise InputError(
                f"{path}: {name} holds values that are not finite floating-point numbers"
            )
