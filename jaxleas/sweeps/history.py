"""The history of a population: who took over from whom, and when."""

import json
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np

from jaxleas.files import parse_json, read_bytes, typed, write_text
from jaxleas.sweeps.evolution import Succession, Values

MAX_BYTES = 2**26


@dataclass(frozen=True)
class Round:
    """One round of evolution, an entry a member.

    Attributes:
        step: at which it was.
        scores: held-out success; None: the member made non-finite numbers.
        parents: whose weights the member went on with.
        values: of the varied fields from then on.
    """

    step: int
    scores: list[float | None]
    parents: list[int]
    values: list[Values]


class History:
    """`history.jsonl`: one line a round of evolution."""

    def __init__(self, path: Path, after_step: int) -> None:
        """Go on with the rounds up to a step; later ones belong to an abandoned future.

        Raises:
            InputError: a line of the file is no round.
        """
        self.path = path
        self._rounds = [each for each in read_history(path) if each.step <= after_step]
        self._write()

    def append(self, step: int, scores: list[float], round_: list[Succession]) -> None:
        """Add a round; a score of nothing is a member that made non-finite numbers."""
        finite = [each if np.isfinite(each) else None for each in scores]
        parents, values = [each.parent for each in round_], [each.values for each in round_]
        self._rounds.append(Round(step, finite, parents, values))
        self._write()

    def _write(self) -> None:
        if self._rounds or self.path.is_file():
            lines = [json.dumps(asdict(each), allow_nan=False) + "\n" for each in self._rounds]
            write_text(self.path, "".join(lines))


def read_history(path: Path) -> list[Round]:
    """Return the rounds of a population's evolution, oldest first; none where there is no file.

    Raises:
        InputError: a line of it is no round.
    """
    if not path.is_file():
        return []
    lines = read_bytes(path, MAX_BYTES).splitlines()
    return [_round(line, f"{path}: line {number}") for number, line in enumerate(lines, start=1)]


def _round(line: bytes, where: str) -> Round:
    return typed(Round, parse_json(line, where), f"{where} is no round of an evolution")


def lineage(history: Sequence[Round], member: int) -> list[int]:
    """Return whose weights a member had before each round, oldest first, and its own number."""
    line = [member]
    for each in reversed(history):
        line.append(each.parents[line[-1]])
    return line[::-1]
