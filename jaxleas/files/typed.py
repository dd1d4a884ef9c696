"""Typed values from plain ones: the content of files, checked in one place."""

import json
from functools import cache
from pathlib import Path
from typing import Any, TypeVar

from jaxleas.files.reading import read_json, require_version
from jaxleas.types import InputError

T = TypeVar("T")


def read_typed(kind: type[T] | Any, path: str | Path, what: str, version: int | None = None) -> T:
    """Return the content of a JSON file as a value of a type.

    Args:
        kind: pydantic model, dataclass, TypedDict, or lists and mappings of them.
        path: path of the file.
        what: name of the kind of file, for messages, such as "figure file".
        version: version that can be read. It is checked first: a file of another version may have
            another form, and then the version is the error to report.

    Raises:
        InputError: the file cannot be read, or is not of this kind; the message names the first
            wrong key.
    """
    content = read_json(path)
    if version is not None and isinstance(content, dict):
        require_version(content, version, path)
    return typed(kind, content, f"{path} is no {what}")


def typed(kind: type[T] | Any, value: Any, sentence: str) -> T:
    """Return a plain value as a value of a type.

    Args:
        kind: type, as for `read_typed`.
        value: plain value, as `read_json` returns it.
        sentence: beginning of the error message.

    Raises:
        InputError: the value is not of the type; the message has the sentence, the first wrong
            key, and what would do.
    """
    from pydantic import ValidationError

    try:
        # Strict, as JSON: a list may become a tuple, but "3" is never a number.
        return _adapter(kind).validate_json(json.dumps(value), strict=True)
    except ValidationError as error:
        first = error.errors()[0]
        key = ".".join(map(str, first["loc"]))
        problem = first["msg"].removeprefix("Value error, ")
        raise InputError(f"{sentence}: {f'{key}: ' if key else ''}{problem}") from error


@cache
def _adapter(kind: Any) -> Any:
    from pydantic import TypeAdapter  # slow to import, and not every command needs it

    return TypeAdapter(kind)
