"""Keys of JSON objects that were written by hand."""

import difflib
from collections.abc import Iterable
from pathlib import Path

from jaxleas.types import InputError


def refuse_misspelt_keys(where: str | Path, keys: Iterable[str], known: Iterable[str]) -> None:
    """Refuse a key that resembles a known one; other keys, such as a comment, are accepted.

    Raises:
        InputError: a key is probably misspelt; the message names it and the key meant.
    """
    names = tuple(known)
    for key in keys:
        nearest = difflib.get_close_matches(key, names, n=1, cutoff=0.75)
        if nearest and key not in names:
            raise InputError(f"{where}: unknown key '{key:.60}'; did you mean '{nearest[0]}'?")
