"""A kind of file: a small valid one, who reads it, and how to mutate it."""

import contextlib
import random
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from tests.robustness.hostile_files import mutations as m
from tests.robustness.hostile_files.mutations import Mutation


@dataclass(frozen=True)
class Kind:
    """One kind of file.

    Attributes:
        name: for people.
        file: its path below the folder it lives in.
        read: what jaxleas does with that path.
        mutate: knows what it holds.
        companions: further files that it needs, by path below the folder.
    """

    name: str
    file: str
    content: bytes
    read: Callable[[Path], Any]
    mutate: Mutation
    companions: dict[str, bytes]

    def mutated(self, draw: random.Random, others: "list[Kind]") -> bytes:
        """Return what a stranger might send."""
        chance = draw.random()
        if chance < 0.55:
            # What was mutated already may be more than Python's own writers and readers take.
            with contextlib.suppress(RecursionError, ValueError, OverflowError):
                return self.mutate(draw, self.content)
        if chance < 0.9:
            return m.mutate_bytes(draw, self.content)
        if chance < 0.95:
            return m.splice(draw, self.content, draw.choice(others).content)
        return draw.choice(others).content


def kind_of(
    name: str,
    path: Path,
    read: Callable[[Path], Any],
    mutate: Mutation,
    *beside: Path,
    at: str = "",
) -> Kind:
    companions = {each.name: each.read_bytes() for each in beside}
    return Kind(name, at or path.name, path.read_bytes(), read, mutate, companions)
