"""Digests of files, which show whether a file has changed since it was read."""

import hashlib
from pathlib import Path

from jaxleas.files.reading import is_file
from jaxleas.types import InputError

_BLOCK = 2**20


def digest_of(path: str | Path) -> str:
    """Return the SHA-256 of a file, as hexadecimal digits.

    Raises:
        InputError: the file is missing, is not a file, or cannot be read.
    """
    if not is_file(path):
        what = "is not a file" if Path(path).exists() else "does not exist"
        raise InputError(f"{path} {what}")
    digest = hashlib.sha256()
    try:
        with open(path, "rb") as file:
            while block := file.read(_BLOCK):
                digest.update(block)
    except OSError as error:
        raise InputError(f"cannot read {path}: {error.strerror or error}") from error
    return digest.hexdigest()


def require_digest(path: str | Path, sha256: str | None) -> None:
    """Refuse a file that is not the one whose digest was recorded.

    Args:
        path: path of the file to read again.
        sha256: digest recorded before; None: any content is accepted.

    Raises:
        InputError: the file is missing, or has changed.
    """
    if sha256 is not None and (found := digest_of(path)) != sha256:
        raise InputError(
            f"{path} has changed since this configuration was resolved: its SHA-256 is"
            f" {found[:12]}..., not {sha256[:12]}...; put the file back, or begin a new run"
        )
