"""Files of learned proposals: plain arrays and one JSON text (docs/files.md)."""

from dataclasses import dataclass, field
from importlib import resources
from pathlib import Path
from typing import Any

import numpy as np

from jaxleas.footsteps.described_file import read_described, write_described
from jaxleas.footsteps.proposal import ARRAYS, Proposal
from jaxleas.types import ControllerIdentity, InputError

VERSION = 1


@dataclass(frozen=True)
class _Metadata:
    """What a file says of its proposal, besides its weights."""

    version: int
    controller: ControllerIdentity
    motion: str
    provenance: dict[str, Any] = field(default_factory=dict)


def write_proposal(path: str | Path, proposal: Proposal) -> None:
    """Write a proposal to a file, whole or not at all."""
    known = _Metadata(VERSION, proposal.controller, proposal.motion, proposal.provenance)
    weights = {name: getattr(proposal, name).astype(np.float32) for name in ARRAYS}
    write_described(path, known, weights)


def read_proposal(path: str | Path) -> Proposal:
    """Read a proposal from a file.

    Raises:
        InputError: the file holds no proposal, is damaged, or is of another version.
    """
    known, arrays = read_described(path, _Metadata, "proposal", VERSION, ARRAYS)
    weights = {name: arrays[name] for name in ARRAYS}
    for name, found in weights.items():
        ndim = 1 if name in ("bias", "hidden_bias", "last") else 2
        if found.ndim != ndim or found.dtype.kind != "f":
            raise InputError(f"{path}: {name} must hold floats in {ndim} dimensions")
    try:
        return Proposal(known.controller, known.motion, **weights, provenance=known.provenance)
    except InputError as error:
        raise InputError(f"{path}: {error}") from error


def shipped_proposal(controller: ControllerIdentity) -> Proposal:
    """Return the package's proposal for a controller.

    Raises:
        InputError: none is shipped for it.
    """
    folder = resources.files("jaxleas.footsteps") / "data"
    name = f"{controller.name}_{controller.robot}_proposal.npz"
    with resources.as_file(folder / name) as path:
        if not path.exists():
            raise InputError(
                f"the package has no proposal for controller {controller.name} on"
                f" {controller.robot}: teach one with jaxleas gait distill"
            )
        return read_proposal(path)
