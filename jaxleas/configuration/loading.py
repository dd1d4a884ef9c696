"""Reading a configuration: YAML files, then the command line, then one validation of it all.

Pydantic validates, and a few lines here parse `--any.field VALUE`. tyro does this too, but its
error messages are boxes of many lines; it does not know which of several files a value came from,
nor pydantic's ranges before parsing. Here every mistake is reported in one sentence, whether it was
made in a file, in the file that this one extends, or on the command line.
"""

from collections.abc import Sequence
from pathlib import Path
from typing import TypeVar

from jaxleas.configuration.fields import help_text
from jaxleas.configuration.layers import Layers, layers_of
from jaxleas.configuration.overrides import COMMAND_LINE, parse_overrides
from jaxleas.configuration.strict import Strict
from jaxleas.configuration.validation import validate
from jaxleas.configuration.yaml_text import dump_yaml

Model = TypeVar("Model", bound=Strict)


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
        layers = [*layers, (COMMAND_LINE, parse_overrides(model, overrides))]
    config = validate(model, layers)
    if wants_help:
        print(help_text(model, config))
        raise SystemExit(0)
    return config


def to_yaml(config: Strict) -> str:
    """Return the resolved configuration as YAML: `load_config` reads an equal one from it."""
    return dump_yaml(config.model_dump(mode="json"))
