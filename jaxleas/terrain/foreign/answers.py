"""What readers in another process give back."""

from dataclasses import dataclass, field
from typing import Any

import numpy as np

READERS = {"glb", "grid_map", "mjcf", "tiff"}
"""Modules of this folder that read files."""
REFUSED = 3
"""Exit code of a process that refuses a file by a sentence."""
LACKS = 4
"""Exit code of a process that lacks a library."""


class RefusedError(Exception):
    """A file cannot be used; the message goes after its name in a sentence."""


@dataclass(frozen=True)
class Answer:
    """Arrays that a file holds.

    Attributes:
        arrays: arrays by name; for a mesh `triangles`, for a map `heights`, `resolution` and
            `origin`, further ones as the reader says.
        notes: what is to be said; each goes after the file's name in a sentence.
    """

    arrays: dict[str, Any]
    notes: list[str] = field(default_factory=list)

    def as_arrays(self) -> dict[str, np.ndarray]:
        """Return all of it as arrays, for a file."""
        plain = {name: np.asarray(value) for name, value in self.arrays.items()}
        return plain | {"notes": np.array(self.notes, dtype=np.str_)}
