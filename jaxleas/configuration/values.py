"""Access to single fields of a configuration by their dotted names, and changed values."""

from collections.abc import Mapping
from typing import Any, TypeVar

from pydantic import ValidationError

from jaxleas.configuration.fields import Field, fields_of, hint
from jaxleas.configuration.former import present_name
from jaxleas.configuration.layers import merge
from jaxleas.configuration.strict import Strict
from jaxleas.configuration.validation import validate
from jaxleas.types import InputError

Model = TypeVar("Model", bound=Strict)


def require_field(model: type[Strict], name: str, source: str) -> Field:
    """Return the field with this dotted name.

    Args:
        model: type of the configuration.
        name: dotted name, as in `ppo.learning_rate`.
        source: place where the name was given, with which error messages begin.

    Raises:
        InputError: there is no such field (the message names the nearest), or it is a whole
            section.
    """
    fields = {field.name: field for field in fields_of(model)}
    name = present_name(model, name)
    if name not in fields:
        raise InputError(f"{source}: there is no {name}{hint(name, list(fields))}")
    if fields[name].section is not None:
        inner = [each for each in fields if each.startswith(f"{name}.")]
        raise InputError(f"{source}: {name} is a section: give a field of it, such as {inner[0]}")
    return fields[name]


def with_values(config: Model, values: Mapping[str, Any], source: str) -> Model:
    """Return a configuration with some fields changed, validated as if a file had stated them.

    Args:
        config: configuration to change.
        values: new values by dotted name.
        source: place where the values were given, with which error messages begin.

    Raises:
        InputError: a value does not fit its field, or the fields do not fit each other.
    """
    stated: dict[str, Any] = {}
    for name, value in values.items():
        for part in reversed(name.split(".")):
            value = {part: value}
        stated = merge(stated, value)
    base = config.model_dump(mode="json")
    return validate(type(config), [("the base configuration", base), (source, stated)])


def require_value(config: Strict, name: str, value: Any, source: str) -> None:
    """Refuse a value that its field can never have.

    Rules about several fields at once are not checked: another field may change along with it.

    Args:
        config: configuration in which to try the value.
        name: dotted name of the field.
        value: value to try.
        source: place where the value was given, with which error messages begin.

    Raises:
        InputError: the value does not fit the field.
    """
    try:
        with_values(config, {name: value}, source)
    except InputError as refusal:
        cause = refusal.__cause__
        errors = cause.errors() if isinstance(cause, ValidationError) else []
        parts = present_name(type(config), name).split(".")
        if any([str(part) for part in error["loc"]][: len(parts)] == parts for error in errors):
            raise


def value_of(config: Any, name: str) -> Any:
    """Return a field's value by its dotted name."""
    for part in name.split("."):
        config = getattr(config, part)
    return config
