"""Fields that have moved: files and command lines may use their former names."""

from collections.abc import Mapping
from typing import Any

from jaxleas.configuration.strict import Strict
from jaxleas.types import InputError


def present_name(model: type[Strict], name: str) -> str:
    """Return the present dotted name of a field: the given one, unless the field has moved."""
    return model.former_names().get(name, name)


def with_present_names(model: type[Strict], stated: dict[str, Any], source: str) -> dict[str, Any]:
    """Return the values that a file states, under the present names of their fields.

    Args:
        model: type of the configuration.
        stated: nested mappings of the values.
        source: name of the file, with which error messages begin.

    Raises:
        InputError: a field is stated under both names, or its new section is not a mapping.
    """
    for former, present in model.former_names().items():
        value, rest = _taken_out(stated, former.split("."))
        if rest is None:
            continue
        stated = _put_in(rest, present.split("."), value, f"{source}: {former} is now {present}")
    return stated


def _taken_out(stated: Any, parts: list[str]) -> tuple[Any, dict[str, Any] | None]:
    """Return a value and the mapping without it; None instead of the mapping if it is missing."""
    if not isinstance(stated, Mapping) or parts[0] not in stated:
        return None, None
    rest = dict(stated)
    if len(parts) == 1:
        return rest.pop(parts[0]), rest
    value, inner = _taken_out(stated[parts[0]], parts[1:])
    if inner is None:
        return None, None
    return value, rest | {parts[0]: inner}


def _put_in(stated: dict[str, Any], parts: list[str], value: Any, sentence: str) -> dict[str, Any]:
    if len(parts) == 1:
        if parts[0] in stated:
            raise InputError(f"{sentence}, and both are given: leave one out")
        return stated | {parts[0]: value}
    inner = stated.get(parts[0], {})
    if not isinstance(inner, Mapping):
        raise InputError(f"{sentence}, but {parts[0]} holds no fields")
    return stated | {parts[0]: _put_in(dict(inner), parts[1:], value, sentence)}
