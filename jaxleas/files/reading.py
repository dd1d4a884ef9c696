"""Reading: every failure is an InputError that names the file, the key and a remedy."""

import os
from pathlib import Path
from typing import Any

import numpy as np

from jaxleas.files.json_text import MAX_JSON_BYTES, parse_json
from jaxleas.files.npz import MAX_BYTES, DamagedError, read_arrays, read_plain_array
from jaxleas.types import InputError


def read_json(path: str | Path) -> Any:
    """Return the value in a JSON file; its numbers are finite, its text is Unicode.

    Raises:
        InputError: the file is missing, unreadable, not JSON, too large or nested too deep.
    """
    return parse_json(read_bytes(path, MAX_JSON_BYTES), str(path))


def read_npz(
    path: str | Path, required: tuple[str, ...], max_bytes: int = MAX_BYTES
) -> dict[str, np.ndarray]:
    """Return the arrays of a .npz file; Python objects inside it are refused.

    Args:
        path: path of the file.
        required: names of arrays that the file must have.
        max_bytes: largest total size of the unpacked arrays.

    Raises:
        InputError: the file is missing, damaged, too large, or lacks an array.
    """
    _require_file(path)
    try:
        arrays = read_arrays(path, max_bytes)
    except DamagedError as error:
        raise InputError(f"{path} is not a readable .npz file: {error}") from error
    missing = [name for name in required if name not in arrays]
    if missing:
        raise InputError(
            f"{path} lacks the array {', '.join(missing)}; it holds"
            f" {', '.join(map(ascii, arrays)).replace(chr(39), '') or 'none':.200}"
        )
    return arrays


def read_array(path: str | Path, max_bytes: int = MAX_BYTES) -> np.ndarray:
    """Return the array of a .npy file; Python objects are refused.

    Raises:
        InputError: the file is missing, damaged, or larger than `max_bytes`.
    """
    require_file(path, max_bytes)
    try:
        return read_plain_array(path)
    except DamagedError as error:
        raise InputError(f"{path} is not a readable .npy file: {error}") from error


def read_bytes(path: str | Path, max_bytes: int) -> bytes:
    """Return the content of a file.

    Raises:
        InputError: the file is missing, unreadable, or larger than `max_bytes`.
    """
    _require_file(path)
    try:
        with Path(path).open("rb") as stream:
            size = os.fstat(stream.fileno()).st_size
            content = stream.read(min(size, max_bytes) + 1)  # `read` allocates this much at once
    except OSError as error:
        raise InputError(f"cannot read {path}: {error.strerror or error}") from error
    if len(content) > max_bytes:
        raise InputError(f"{path} is larger than the {max_bytes} bytes such a file may have")
    return content


def require_file(path: str | Path, max_bytes: int) -> None:
    """Refuse a file that is missing, or larger than `max_bytes`, before it is read.

    Raises:
        InputError: the message says which.
    """
    _require_file(path)
    size = Path(path).stat().st_size
    if size > max_bytes:
        raise InputError(f"{path} is {size} bytes, more than the {max_bytes} such a file may have")


def require_version(content: dict[str, Any], version: int, where: str | Path) -> None:
    """Refuse a file of another version; a file that states no version is of the first.

    Args:
        content: content of the file.
        version: version that can be read.
        where: name of the file, for the message.

    Raises:
        InputError: the file is of another version, which the message names.
    """
    found = content.get("version", 1)
    if found != version or isinstance(found, bool):
        raise InputError(
            f"{where} is of version {str(found)[:20]}; this jaxleas reads version {version}: make"
            " it again, or use the jaxleas that wrote it"
        )


def require_version_array(arrays: dict[str, np.ndarray], version: int, where: str | Path) -> None:
    """Refuse a .npz whose array `version` states another one; see `require_version`."""
    found = arrays.get("version")
    if found is not None:
        stated = found.item() if found.size == 1 else f"an array of shape {found.shape}"
        require_version({"version": stated}, version, where)


def is_file(path: str | Path) -> bool:
    """Return whether a file of this name exists; an impossible name counts as missing."""
    try:
        return Path(path).is_file()
    except (OSError, ValueError):
        return False


def _require_file(path: str | Path) -> None:
    try:
        if Path(path).is_dir():
            raise InputError(f"{path} is a folder, not a file")
        if not Path(path).is_file():
            raise InputError(f"{path} does not exist")
    except (OSError, ValueError) as error:  # an impossible name
        raise InputError(f"{str(path)!r:.200} is not a file: {error}") from error
