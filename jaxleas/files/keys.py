"""Keys of JSON objects that somebody wrote by hand."""

import difflib
from collections.abc import Iterable
from pathlib import Path

from jaxleas.types.errors import InputError


def refuse_misspelt_keys(where: str | Path, keys: Iterable[str], known: Iterable[str]) -> None:
    """Refuse a key that looks like a known one; others, a comment say, are let pass.

    Raises:
        InputError: says which key, and which was probably meant.
    """
    names = tuple(known)
    for key in keys:
        nearest = difflib.get_close_matches(key, names, n=1, cutoff=0.75)
        if nearest and key not in names:
            raise InputError(f"{where}: unknown key '{key:.60}'; did you mean '{nearest[0]}'?")
