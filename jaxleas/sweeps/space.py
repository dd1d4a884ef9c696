"""Checks of a searched space against the fields of a run's configuration."""

import typing
from collections.abc import Mapping
from typing import Any

from jaxleas.configuration import (
    require_field,
    require_value,
)
from jaxleas.sweeps.config import Dimension
from jaxleas.training import (
    RunConfig,
)
from jaxleas.types import InputError

# Sections that define the measure must not be searched: trials would not be comparable.
MEASURES = ("held_out.", "final.")


def check_dimension(name: str, dimension: Dimension, base: RunConfig, source: str) -> bool:
    """Return whether the field holds whole numbers.

    Raises:
        InputError: the field cannot be searched, or not in this way.
    """
    field = require_field(type(base), name, source)
    where = f"{source}.{name}"
    if name == "seed":
        raise InputError(f"{where}: training seeds are listed under seeds, not searched")
    if name.startswith(MEASURES):
        raise InputError(f"{where} belongs to what measures the trials: put it under set")
    if dimension.choices is not None:
        for choice in dimension.choices:
            require_value(base, name, choice, where)
        return False
    kind = _number_type(field.info.annotation)
    if kind is None:
        raise InputError(f"{where}: {name} is no single number, so it has no range: give choices")
    low, high = dimension.ends
    for end, value in (("low", low), ("high", high), ("step", dimension.step)):
        if kind is int and value is not None and value != int(value):
            raise InputError(f"{where}: {end} = {value:g}, but {name} holds whole numbers")
    for value in (low, high):
        require_value(base, name, kind(value), where)
    return kind is int


def _number_type(annotation: Any) -> type | None:
    """Return int or float for a field that holds one number, else None."""
    if typing.get_origin(annotation) is typing.Annotated:
        return _number_type(typing.get_args(annotation)[0])
    return annotation if annotation in (int, float) else None


def check_conditions(space: Mapping[str, Dimension], source: str) -> None:
    """Refuse a dimension that depends on a field below it, or on a value that never occurs.

    Raises:
        InputError: a condition can never hold; the message names the key.
    """
    above: dict[str, Dimension] = {}
    for name, dimension in space.items():
        where = f"{source}: space.{name}.only_when"
        for other, wanted in dimension.only_when.items():
            if other not in above:
                raise InputError(f"{where}: {other} does not stand above {name} in the space")
            for value in allowed(wanted):
                if not _can_be(above[other], value):
                    raise InputError(f"{where}: {other} is never {value!r} in this space")
        above[name] = dimension


def allowed(wanted: Any) -> list[Any]:
    """Return the values that a condition names, which are one value or a list of several."""
    return wanted if isinstance(wanted, list) else [wanted]


def _can_be(dimension: Dimension, value: Any) -> bool:
    if dimension.choices is not None:
        return value in dimension.choices
    low, high = dimension.ends
    number = isinstance(value, int | float) and not isinstance(value, bool)
    return number and low <= value <= high
