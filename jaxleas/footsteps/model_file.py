"""Files of motion models: plain arrays and one JSON text (docs/files.md)."""

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from jaxleas.footsteps.described_file import read_described, write_described
from jaxleas.footsteps.features import Predictors
from jaxleas.footsteps.model import Errors, FeetMode, MotionModel
from jaxleas.types import ControllerIdentity, InputError

VERSION = 1


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
    weights = {f"weights_{pair}": each for pair, each in enumerate(model.weights)}
    write_described(path, _Metadata(version=VERSION, **values), weights)


def read_motion_model(path: str | Path) -> MotionModel:
    """Read motion models from a file.

    Raises:
        InputError: the file holds no motion models, is damaged, or is of another version.
    """
    metadata, arrays = read_described(path, _Metadata, "motion models", VERSION, ("weights_0",))
    names = [f"weights_{pair}" for pair in range(len(metadata.controller.pairs))]
    missing = [name for name in names if name not in arrays]
    if missing:
        raise InputError(f"{path} lacks the array {', '.join(missing)}")
    values = {name: value for name, value in vars(metadata).items() if name != "version"}
    try:
        return MotionModel(weights=tuple(arrays[name] for name in names), **values)
    except InputError as error:
        raise InputError(f"{path}: {error}") from error
