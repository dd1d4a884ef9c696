"""The option --allow of every command: the user's own code that may be run."""

import re
from typing import Annotated

from jaxleas.types import InputError


class _OwnCode:
    """What the option takes: for a command's help, and for what reads the command line."""

    def describe(self) -> str:
        """Return what each value looks like, and why it must be given."""
        return "each as MODULE:CLASS; code that only a file names is never imported"

    def parse(self, text: str) -> str:
        """Return a value given on the command line (`require_own_name`)."""
        return require_own_name(text)


Allow = Annotated[tuple[str, ...], _OwnCode()]
"""Type of a command's parameter `allow`: the user's own code that a person has named."""


def require_own_name(text: str) -> str:
    """Return the name of the user's own code as given with --allow.

    Raises:
        InputError: it does not have the form MODULE:CLASS.
    """
    if not re.fullmatch(r"[\w.]+:\w+", text):
        raise InputError(
            f"--allow {text} is no MODULE:CLASS; my_conditions:LevelGround, say, is the class"
            " LevelGround of my_conditions.py in this folder"
        )
    return text
