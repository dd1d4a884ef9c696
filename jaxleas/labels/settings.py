"""Planners' settings on a command line."""

from collections.abc import Mapping, Sequence
from typing import Any

from jaxleas.configuration import parse_yaml
from jaxleas.types import InputError


def with_parameters(given: Mapping[str, Any], further: Mapping[str, Any]) -> dict[str, Any]:
    """Return the settings given by options of their own and those given by --parameters, together.

    Args:
        given: settings that have an option, by name; None where the option is not used.
        further: settings given by --parameters, by name.

    Raises:
        InputError: a setting is given both ways.
    """
    if twice := next((name for name in further if given.get(name) is not None), None):
        option = twice.replace("_", "-")
        raise InputError(f"--{option} and --parameters {twice} say the same: give one of them")
    return {**given, **further}


def settings_of(words: Sequence[str]) -> dict[str, Any]:
    """Return settings written as NAME=VALUE, with values as in YAML.

    Raises:
        InputError: a word is not such a pair.
    """
    settings = {}
    for word in words:
        name, equals, text = word.partition("=")
        if not (name.isidentifier() and equals):
            raise InputError(f"--parameters {word}: they look like longest_step=0.3")
        try:
            settings[name] = parse_yaml(text)
        except ValueError as error:
            raise InputError(f"--parameters {word}: {text} is not YAML") from error
    return settings
