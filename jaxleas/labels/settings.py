"""Planners' settings on a command line."""

from collections.abc import Sequence
from typing import Any

from jaxleas.configuration.yaml_text import parse_yaml
from jaxleas.types.errors import InputError


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
