"""Files of plain arrays, and one JSON text that describes them: models and proposals."""

import json
from dataclasses import asdict
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from jaxleas.files import parse_json, read_npz, require_version, typed, write_npz

MAX_BYTES = 2**24
DESCRIPTION = "metadata"
"""Name of the array that holds the JSON text."""
T = TypeVar("T")


def write_described(path: str | Path, description: Any, arrays: dict[str, np.ndarray]) -> None:
    """Write arrays and what describes them to a file, whole or not at all.

    Args:
        path: path of the file.
        description: instance of a dataclass.
        arrays: arrays by name.
    """
    write_npz(path, **{DESCRIPTION: np.array(json.dumps(asdict(description)))}, **arrays)


def read_described(
    path: str | Path, kind: type[T], what: str, version: int, required: tuple[str, ...]
) -> tuple[T, dict[str, np.ndarray]]:
    """Read what describes the arrays of a file, and the arrays.

    Args:
        path: path of the file.
        kind: type of the description.
        what: what the file should hold, in words without an article.
        version: version that can be read.
        required: names of arrays that it must hold, besides the description.

    Raises:
        InputError: the file holds something else, is damaged, or is of another version.
    """
    arrays = read_npz(path, (DESCRIPTION, *required), MAX_BYTES)
    content = parse_json(str(arrays[DESCRIPTION]), f"{path}: {DESCRIPTION}")
    if isinstance(content, dict):
        require_version(content, version, path)
    return typed(kind, content, f"{path}: {DESCRIPTION} of no {what}"), arrays
