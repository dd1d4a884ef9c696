"""Under which name somebody else's service knows a run: kept in the run folder."""

from collections.abc import Callable
from pathlib import Path

from jaxleas.files import read_json, write_json
from jaxleas.types.errors import InputError


def lasting_identity(path: Path, make: Callable[[], str]) -> str:
    """Return the identity in a file, made and written there the first time.

    Args:
        path: of the file.
        make: returns a new one.

    Raises:
        InputError: the file cannot be read or written, or holds none.
    """
    if not path.is_file():
        write_json(path, {"run": make()})
    content = read_json(path)
    run = content.get("run") if isinstance(content, dict) else None
    if not isinstance(run, str) or not run:
        raise InputError(f"{path} names no run: remove it, and a new one is begun")
    return run
