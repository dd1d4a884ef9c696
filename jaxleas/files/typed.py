"""Plain values as typed ones: what a file holds and a reader counts on, checked in one place."""

import json
from functools import cache
from pathlib import Path
from typing import Any, TypeVar

from jaxleas.files.reading import read_json, require_version
from jaxleas.types.errors import InputError

T = TypeVar("T")


def read_typed(kind: type[T] | Any, path: str | Path, what: str, version: int | None = None) -> T:
    """Return what a JSON file holds, as a value of a type.

    Args:
        kind: a pydantic model, a dataclass, a TypedDict, or lists and mappings of them.
        path: of the file.
        what: it should be: "figure file".
        version: that is read. Looked at first: a file of another one may well be of another form,
            and its version is then what is wrong with it.

    Raises:
        InputError: the file cannot be read, or is no such thing: the first key that is wrong is
            named.
    """
    content = read_json(path)
    if version is not None and isinstance(content, dict):
        require_version(content, version, path)
    return typed(kind, content, f"{path} is no {what}")


def typed(kind: type[T] | Any, value: Any, sentence: str) -> T:
    """Return a plain value as a value of a type.

    Args:
        kind: as above.
        value: as `read_json` gives it.
        sentence: what the refusal begins with.

    Raises:
        InputError: the sentence, the first key that is wrong, and what would do.
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
