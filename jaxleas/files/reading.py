"""Reading: every failure is an InputError that names the file, the key and what would do."""

import difflib
import json
import struct
import zipfile
import zlib
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np

from jaxleas.types.errors import InputError

MAX_BYTES = 2**30  # a larger array file is a mistake or an attack, not a map

# Whatever zipfile, zlib and numpy raise over bytes that are not what they claim to be.
_DAMAGES = (
    EOFError,
    KeyError,
    MemoryError,
    NotImplementedError,
    OSError,
    OverflowError,
    RuntimeError,
    ValueError,
    struct.error,
    zipfile.BadZipFile,
    zlib.error,
)


def read_json(path: str | Path) -> Any:
    """Return the value in a JSON file.

    Raises:
        InputError: the file is missing, unreadable or not JSON.
    """
    text = _bytes(path).decode("utf-8", errors="replace")
    try:
        return json.loads(text, parse_constant=lambda name: _refuse_constant(path, name))
    except (ValueError, RecursionError) as error:  # ValueError: also numbers of 5000 digits
        raise InputError(f"{path} is not valid JSON: {error}") from error


def read_npz(path: str | Path, required: tuple[str, ...]) -> dict[str, np.ndarray]:
    """Return the arrays of a .npz file; Python objects inside it are refused.

    Args:
        path: the file.
        required: names of arrays that must be there.

    Raises:
        InputError: the file is missing, truncated, too large, or lacks an array.
    """
    _require_file(path)
    try:
        with zipfile.ZipFile(path) as archive:
            size = sum(entry.file_size for entry in archive.infolist())
        if size > MAX_BYTES:
            raise InputError(f"{path} unpacks to {size} bytes, more than the {MAX_BYTES} allowed")
        with np.load(path, allow_pickle=False) as archive:
            arrays = {name: archive[name] for name in archive.files}
    except _DAMAGES as error:
        raise InputError(f"{path} is not a readable .npz file: {error}") from error
    missing = [name for name in required if name not in arrays]
    if missing:
        raise InputError(
            f"{path} lacks the array {', '.join(missing)}; it holds {', '.join(arrays) or 'none'}"
        )
    return arrays


def _bytes(path: str | Path) -> bytes:
    _require_file(path)
    try:
        return Path(path).read_bytes()
    except OSError as error:
        raise InputError(f"cannot read {path}: {error.strerror or error}") from error


def _require_file(path: str | Path) -> None:
    if Path(path).is_dir():
        raise InputError(f"{path} is a folder, not a file")
    if not Path(path).is_file():
        raise InputError(f"{path} does not exist")


def _refuse_constant(path: str | Path, name: str) -> None:
    raise InputError(f"{path} holds {name}, which is neither JSON nor a usable number")


def refuse_misspelt_keys(where: str | Path, keys: Iterable[str], known: Iterable[str]) -> None:
    """Refuse a key that looks like a known one; others, a comment say, are let pass.

    Raises:
        InputError: says which key, and which was probably meant.
    """
    for key in keys:
        nearest = difflib.get_close_matches(key, known, n=1, cutoff=0.75)
        if nearest and nearest[0] != key:
            raise InputError(f"{where}: unknown key '{key}'; did you mean '{nearest[0]}'?")
