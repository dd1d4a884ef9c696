"""Reading one checkpoint file, checked, so that damage is noticed and never restored."""

from pathlib import Path
from typing import Any

import numpy as np

from jaxleas.files import DamagedError, parse_json, read_arrays
from jaxleas.types import InputError

FORMAT = 1


class CheckpointDamageError(Exception):
    """A checkpoint file that cannot be read whole."""


def read_checkpoint(path: Path, manifest_only: bool = False) -> tuple[Any, dict[str, np.ndarray]]:
    """Return manifest and arrays; the file may have any size, but cannot unpack to more."""
    try:
        arrays = read_arrays(path, max_bytes=None, only="manifest" if manifest_only else None)
        manifest = parse_json(arrays.pop("manifest").tobytes(), "its manifest")
    except (DamagedError, KeyError, InputError) as error:
        raise CheckpointDamageError(ascii(str(error))[1:100]) from error
    if not isinstance(manifest, dict) or manifest.get("format") != FORMAT:
        found = manifest.get("format") if isinstance(manifest, dict) else None
        raise InputError(f"{path} is in format {str(found)[:20]}; this version reads {FORMAT}")
    if not _is_manifest(manifest):
        raise CheckpointDamageError("its manifest is not that of a checkpoint")
    stated = {entry["name"] for entry in manifest["leaves"] if "value" not in entry}
    if not manifest_only and stated != arrays.keys():
        raise CheckpointDamageError("an array is missing")
    return manifest, arrays


def _is_manifest(manifest: dict[str, Any]) -> bool:
    leaves, score = manifest.get("leaves"), manifest.get("score", "missing")
    return (
        isinstance(leaves, list)
        and all(
            isinstance(leaf, dict)
            and isinstance(leaf.get("name"), str)
            and isinstance(leaf.get("type"), str)
            and isinstance(leaf.get("random_key", ""), str)
            and isinstance(leaf.get("value", 0), bool | int | float)
            for leaf in leaves
        )
        and (score is None or (isinstance(score, int | float) and not isinstance(score, bool)))
        and isinstance(manifest.get("note"), dict)
    )
