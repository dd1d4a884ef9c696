"""The values that a YAML file and those that it extends state."""

import os
from pathlib import Path
from typing import Any

from jaxleas.configuration.yaml_text import read_mapping
from jaxleas.files import config_file
from jaxleas.types import InputError

# Sources of values, weakest first: (name for messages, stated values).
Layers = list[tuple[str, dict[str, Any]]]
MAX_EXTENDED = 20


def layers_of(path: str | Path) -> Layers:
    """Return the values that a YAML file and those that it extends state, the most basic first.

    Args:
        path: path of the file, or name of a configuration that comes with the package.

    Raises:
        InputError: a file is missing, is not a mapping, or extends itself.
    """
    return _layers(config_file(path), ())


def _layers(path: Path, above: tuple[Path, ...]) -> Layers:
    """Return the values that `path` and the files it extends state, the most basic first."""
    stated = read_mapping(path)  # first, as it refuses what is no name of a file
    if path.resolve() in above:
        raise InputError(f"{path} extends itself: {' -> '.join(map(str, (*above, path)))}")
    parent = stated.pop("extends", None)
    if parent is None:
        return [(str(path), stated)]
    if not isinstance(parent, str) or "\0" in parent:
        raise InputError(f"{path}: extends is {parent!r:.60}, but it should name one YAML file")
    _require_below(path, parent)
    if len(above) >= MAX_EXTENDED:
        raise InputError(f"{path}: more than {MAX_EXTENDED} files extend one another")
    below = config_file(parent, path.parent)
    return [*_layers(below, (*above, path.resolve())), (str(path), stated)]


def _require_below(path: Path, parent: str) -> None:
    """Refuse to read a file outside the folder of the one that extends it: it may be a stranger's.

    A link inside the folder is the owner's own decision.
    """
    folder = path.parent.absolute()
    wanted = Path(os.path.normpath(folder / parent))
    if Path(parent).is_absolute() or not wanted.is_relative_to(folder):
        raise InputError(
            f"{path}: extends is {parent!r:.200}, but it should lie in {path.parent} or below it"
        )


def merge(below: Any, above: Any) -> Any:
    """Return `below` overridden by everything that `above` states, key by key."""
    if not isinstance(below, dict) or not isinstance(above, dict):
        return above
    return {**below, **{key: merge(below.get(key), value) for key, value in above.items()}}
