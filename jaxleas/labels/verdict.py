"""Verdicts as JSON values."""

from dataclasses import asdict, fields
from functools import cache
from typing import Any

from pydantic import BaseModel, ValidationError, create_model

from jaxleas.types import InputError, Verdict

ADDED_SINCE = {"cause": None}
"""Keys that files from before lack, with what they stand for there."""


def verdict_to_json(verdict: Verdict) -> dict[str, Any]:
    """Return a verdict as a JSON value."""
    return asdict(verdict)


def verdict_from_json(value: Any, where: str) -> Verdict:
    """Return the verdict in a JSON value.

    Raises:
        InputError: the value is not a verdict; the message names `where`.
    """
    if isinstance(value, dict):
        value = ADDED_SINCE | value
    names = set(Verdict.__dataclass_fields__)
    if not isinstance(value, dict) or set(value) != names:
        raise InputError(f"{where} is no verdict: it needs the keys {', '.join(sorted(names))}")
    try:
        _model().model_validate(value, strict=True)
    except ValidationError as error:
        first = error.errors()[0]
        key = ".".join(map(str, first["loc"]))
        raise InputError(f"{where} is no verdict: {key}: {first['msg']}") from error
    return Verdict(**value)


@cache
def _model() -> type[BaseModel]:
    """Return the model that checks the types: a dataclass by itself accepts anything."""
    return create_model("Verdict", **{each.name: (each.type, ...) for each in fields(Verdict)})  # type: ignore[call-overload]
