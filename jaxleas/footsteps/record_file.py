"""Files of footsteps: plain arrays and one JSON text (docs/files.md)."""

import json
from dataclasses import asdict, dataclass, field, fields
from pathlib import Path
from typing import Any

import numpy as np

from jaxleas.files import (
    parse_json,
    read_npz,
    require_version,
    typed,
    write_npz,
)
from jaxleas.footsteps.records import Definition, FootstepRecords, Footsteps
from jaxleas.types import ControllerIdentity, InputError

VERSION = 1
MAX_BYTES = 2**31
"""Largest size of the unpacked arrays: five million footsteps."""
_NAMES = tuple(each.name for each in fields(Footsteps))


@dataclass(frozen=True)
class _Metadata:
    """What a file says of its footsteps."""

    version: int
    controller: ControllerIdentity
    definition: Definition
    rejected: dict[str, int] = field(default_factory=dict)
    collection: dict[str, Any] = field(default_factory=dict)
    provenance: dict[str, Any] = field(default_factory=dict)


def write_footsteps(path: str | Path, records: FootstepRecords) -> None:
    """Write footsteps to a file, whole or not at all."""
    metadata = _Metadata(
        VERSION,
        *(records.controller, records.definition, records.rejected),
        *(records.collection, records.provenance),
    )
    arrays = {name: getattr(records.footsteps, name) for name in _NAMES}
    write_npz(path, metadata=np.array(json.dumps(asdict(metadata))), **arrays)


def read_footsteps(path: str | Path) -> FootstepRecords:
    """Read footsteps from a file.

    Raises:
        InputError: the file holds no footsteps, is damaged, or is of another version; the message
            names the array or key.
    """
    arrays = read_npz(path, ("metadata", *_NAMES), MAX_BYTES)
    content = parse_json(str(arrays["metadata"]), f"{path}: metadata")
    if isinstance(content, dict):
        require_version(content, VERSION, path)
    metadata = typed(_Metadata, content, f"{path}: metadata of no footsteps")
    try:
        return FootstepRecords(
            Footsteps(**{name: arrays[name] for name in _NAMES}),
            *(metadata.controller, metadata.definition, metadata.rejected),
            *(metadata.collection, metadata.provenance),
        )
    except InputError as error:
        raise InputError(f"{path}: {error}") from error
