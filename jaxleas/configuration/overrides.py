"""Overrides of a configuration on the command line: --any.field VALUE."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from jaxleas.configuration.fields import fields_of, hint
from jaxleas.configuration.former import present_name
from jaxleas.configuration.layers import merge
from jaxleas.configuration.strict import Strict
from jaxleas.configuration.yaml_text import parse_yaml
from jaxleas.types import InputError

COMMAND_LINE = "command line"


def parse_overrides(model: type[Strict], arguments: Sequence[str]) -> dict[str, Any]:
    """Return the values of `--any.field VALUE` and `--any.field=VALUE`, nested as in the model."""
    fields = {field.name: field for field in fields_of(model)}
    stated: dict[str, Any] = {}
    rest = list(arguments)
    while rest:
        option, equals, text = rest.pop(0).partition("=")
        name = option.removeprefix("--").replace("-", "_")
        if not option.startswith("--") or not name:
            raise InputError(
                f"{COMMAND_LINE}: '{option}' stands alone; overrides look like --any.field VALUE"
            )
        name = present_name(model, name)
        if name not in fields:
            raise InputError(f"{COMMAND_LINE}: there is no {option}{hint(name, list(fields), 2)}")
        if not equals:
            if not rest or rest[0].startswith("--"):
                raise InputError(f"{COMMAND_LINE}: {option} needs a value: {option} VALUE")
            text = rest.pop(0)
        try:
            value = text if fields[name].info.annotation in (str, Path) else parse_yaml(text)
        except ValueError as error:
            raise InputError(f"{COMMAND_LINE}: {option} {text} is not YAML: {error}") from error
        for part in reversed(name.split(".")):
            value = {part: value}
        stated = merge(stated, value)
    return stated
