"""Files of motion models: plain arrays and one JSON text (docs/files.md)."""

import json
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from jaxleas.files import parse_json, read_npz, require_version, typed, write_npz
from jaxleas.footsteps.features import Predictors
from jaxleas.footsteps.model import Errors, FeetMode, MotionModel
from jaxleas.types import ControllerIdentity, InputError

VERSION = 1
MAX_BYTES = 2**24


@dataclass(frozen=True)
class _Metadata:
    """What a file says of its models, besides their weights."""

    version: int
    controller: ControllerIdentity
    predictors: Predictors
    feet: FeetMode
    fastest: dict[str, float]
    longest_stride: float
    largest_turn: float
    errors: Errors
    provenance: dict[str, Any] = field(default_factory=dict)


def write_motion_model(path: str | Path, model: MotionModel) -> None:
    """Write motion models to a file, whole or not at all."""
    values = {
        name: getattr(model, name) for name in _Metadata.__dataclass_fields__ if name != "version"
    }
    metadata = json.dumps(asdict(_Metadata(version=VERSION, **values)))
    weights = {f"weights_{pair}": each for pair, each in enumerate(model.weights)}
    write_npz(path, metadata=np.array(metadata), **weights)


def read_motion_model(path: str | Path) -> MotionModel:
    """Read motion models from a file.

    Raises:
        InputError: the file holds no motion models, is damaged, or is of another version.
    """
    arrays = read_npz(path, ("metadata", "weights_0"), MAX_BYTES)
    content = parse_json(str(arrays["metadata"]), f"{path}: metadata")
    if isinstance(content, dict):
        require_version(content, VERSION, path)
    metadata = typed(_Metadata, content, f"{path}: metadata of no motion models")
    names = [f"weights_{pair}" for pair in range(len(metadata.controller.pairs))]
    missing = [name for name in names if name not in arrays]
    if missing:
        raise InputError(f"{path} lacks the array {', '.join(missing)}")
    values = {name: value for name, value in vars(metadata).items() if name != "version"}
    try:
        return MotionModel(weights=tuple(arrays[name] for name in names), **values)
    except InputError as error:
        raise InputError(f"{path}: {error}") from error
