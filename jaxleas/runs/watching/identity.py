"""Identity of a run in an external service, kept in the run folder."""

from collections.abc import Callable
from pathlib import Path

from jaxleas.files import read_json, write_json
from jaxleas.types import InputError


def lasting_identity(path: Path, make: Callable[[], str]) -> str:
    """Return the identity in a file; it is made and written there the first time.

    Args:
        path: path of the file.
        make: function that returns a new identity.

    Raises:
        InputError: the file cannot be read or written, or holds no identity.
    """
    if not path.is_file():
        write_json(path, {"run": make()})
    content = read_json(path)
    run = content.get("run") if isinstance(content, dict) else None
    if not isinstance(run, str) or not run:
        raise InputError(f"{path} names no run: remove it, and a new one is begun")
    return run
