"""Reading a configuration: YAML files, then the command line, then one validation of it all.

Pydantic validates, and a few lines here parse `--any.field VALUE`. tyro does this too, but its
error messages are boxes of many lines; it does not know which of several files a value came from,
nor pydantic's ranges before parsing. Here every mistake is reported in one sentence, whether it was
made in a file, in the file that this one extends, or on the command line.
"""

import json
import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any, TypeVar

from pydantic import ValidationError

from jaxleas.configuration.fields import fields_of, help_text, nearest
from jaxleas.configuration.former import present_name, with_present_names
from jaxleas.configuration.strict import Strict
from jaxleas.configuration.yaml_text import dump_yaml, parse_yaml, read_mapping
from jaxleas.types import InputError

Model = TypeVar("Model", bound=Strict)
# Sources of values, weakest first: (name for messages, stated values).
Layers = list[tuple[str, dict[str, Any]]]
COMMAND_LINE = "command line"
MAX_EXTENDED = 20


def load_config(model: type[Model], path: str | Path, overrides: Sequence[str] = ()) -> Model:
    """Return the configuration that a YAML file and the command line state together.

    A file may state `extends: other.yaml` (relative to itself) and then only what differs.

    Args:
        model: type of the configuration.
        path: path of the YAML file.
        overrides: arguments such as `--ppo.discount 0.97` or `--ppo.discount=0.97`, for any field
            of the model; values are written as in YAML, and the last of several wins. If `--help`
            is among them, all fields are printed and the program ends.

    Raises:
        InputError: the configuration is invalid; one sentence names the file (or the command
            line), the key, what was given, and what would do.
    """
    return load_layers(model, layers_of(path), overrides)


def load_layers(model: type[Model], layers: Layers, overrides: Sequence[str] = ()) -> Model:
    """Return the configuration that files already read and the command line state together.

    Args:
        model: type of the configuration.
        layers: values that the files state, the weakest first.
        overrides: arguments, as for `load_config`.

    Raises:
        InputError: the configuration is invalid, as for `load_config`.
    """
    wants_help = any(argument in ("--help", "-h") for argument in overrides)
    if overrides and not wants_help:
        layers = [*layers, (COMMAND_LINE, _parse_overrides(model, overrides))]
    config = validate(model, layers)
    if wants_help:
        print(help_text(model, config))
        raise SystemExit(0)
    return config


def layers_of(path: str | Path) -> Layers:
    """Return the values that a YAML file and those that it extends state, the most basic first.

    Raises:
        InputError: a file is missing, is not a mapping, or extends itself.
    """
    return _layers(Path(path), ())


def to_yaml(config: Strict) -> str:
    """Return the resolved configuration as YAML: `load_config` reads an equal one from it."""
    return dump_yaml(config.model_dump(mode="json"))


def _layers(path: Path, above: tuple[Path, ...]) -> Layers:
    """Return the values that `path` and the files it extends state, the most basic first."""
    if path.resolve() in above:
        raise InputError(f"{path} extends itself: {' -> '.join(map(str, (*above, path)))}")
    stated = read_mapping(path)
    parent = stated.pop("extends", None)
    if parent is None:
        return [(str(path), stated)]
    if not isinstance(parent, str) or "\0" in parent:
        raise InputError(f"{path}: extends is {parent!r:.60}, but it should name one YAML file")
    _require_below(path, parent)
    if len(above) >= MAX_EXTENDED:
        raise InputError(f"{path}: more than {MAX_EXTENDED} files extend one another")
    return [*_layers(path.parent / parent, (*above, path.resolve())), (str(path), stated)]


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


def _parse_overrides(model: type[Strict], arguments: Sequence[str]) -> dict[str, Any]:
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


def merge(below: Any, above: Any) -> Any:
    """Return `below` overridden by everything that `above` states, key by key."""
    if not isinstance(below, dict) or not isinstance(above, dict):
        return above
    return {**below, **{key: merge(below.get(key), value) for key, value in above.items()}}


def validate(model: type[Model], layers: Layers) -> Model:
    """Return the configuration that layers state together, given the weakest first.

    Raises:
        InputError: the value is invalid; the message names the layer, the key, and what would do.
    """
    layers = [(label, with_present_names(model, layer, label)) for label, layer in layers]
    stated: dict[str, Any] = {}
    for _, layer in layers:
        stated = merge(stated, layer)
    try:
        # Strict, as JSON: a list may become a tuple and a text a path, but "3" is never a number.
        return model.model_validate_json(json.dumps(stated, default=str), strict=True)
    except ValidationError as error:
        first, *others = error.errors()
        more = f" (and {len(others)} more)" if others else ""
        raise InputError(_sentence(model, layers, first) + more) from error


def _sentence(model: type[Strict], layers: Layers, error: Any) -> str:
    """Return an error of pydantic as one sentence with its source."""
    parts = [str(part) for part in error["loc"]]
    name = ".".join(parts)
    source = next(
        (label for label, layer in reversed(layers) if _states(layer, parts)), layers[0][0]
    )
    problem = error["msg"].removeprefix("Value error, ").replace("Input should", "it should")
    if error["type"] == "extra_forbidden":
        names = [field.name for field in fields_of(model)]
        return f"{source}: there is no {name}{hint(name, names)}"
    if error["type"].startswith("union_tag"):  # the field that selects a kind of section
        tag = f"{name}.{error['ctx']['discriminator'].strip(chr(39))}"
        kinds = error["ctx"].get("expected_tags")
        if kinds is None:
            return f"{source}: {tag} is missing and has no default"
        return f"{source}: {tag} is {error['ctx']['tag']!r}, but it should be one of {kinds}"
    if error["type"] == "too_short":
        least = error["ctx"]["min_length"]
        return f"{source}: {name} is {error['input']!r}, but it should hold at least {least}"
    if error["type"] == "missing":
        return f"{source}: {name} is missing and has no default"
    if isinstance(error["input"], dict) or not parts:  # a rule about several fields at once
        return f"{source}: {f'{name}: ' if name else ''}{problem}"
    return f"{source}: {name} is {error['input']!r}, but {problem}"


def _states(layer: Any, parts: list[str]) -> bool:
    for part in parts:
        if isinstance(layer, list):
            return True  # lists are replaced whole
        if not isinstance(layer, dict) or part not in layer:
            return False
        layer = layer[part]
    return True


def hint(name: str, names: list[str], dashes: int = 0) -> str:
    """Return the end of a message about an unknown field: the nearest of `names`, or all."""
    close = nearest(name, names)
    if close is not None:
        return f"; perhaps you meant {'-' * dashes}{close}"
    section = name.rpartition(".")[0]
    prefix = f"{section}." if any(each.startswith(f"{section}.") for each in names) else ""
    there = [each for each in names if each.startswith(prefix) and "." not in each[len(prefix) :]]
    return f"; there are {', '.join(there)}"
