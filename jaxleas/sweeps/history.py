"""The history of a population: which member copied which, and when."""

import json
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np

from jaxleas.files import parse_json, read_bytes, typed, write_text
from jaxleas.sweeps.evolution import Succession, Values

MAX_BYTES = 2**26


@dataclass(frozen=True)
class Round:
    """One round of evolution, with one entry per member.

    Attributes:
        step: training step of the round.
        scores: held-out success; None: the member made non-finite numbers.
        parents: number of the member whose weights each member continued with.
        values: values of the varied fields from then on.
    """

    step: int
    scores: list[float | None]
    parents: list[int]
    values: list[Values]


class History:
    """The file `history.jsonl`, with one line per round of evolution."""

    def __init__(self, path: Path, after_step: int) -> None:
        """Open the file and keep the rounds up to a step; later ones are obsolete.

        Raises:
            InputError: a line of the file is not a round.
        """
        self.path = path
        self._rounds = [each for each in read_history(path) if each.step <= after_step]
        self._write()

    def append(self, step: int, scores: list[float], round_: list[Succession]) -> None:
        """Add a round; a NaN score marks a member that made non-finite numbers."""
        finite = [each if np.isfinite(each) else None for each in scores]
        parents, values = [each.parent for each in round_], [each.values for each in round_]
        self._rounds.append(Round(step, finite, parents, values))
        self._write()

    def _write(self) -> None:
        if self._rounds or self.path.is_file():
            lines = [json.dumps(asdict(each), allow_nan=False) + "\n" for each in self._rounds]
            write_text(self.path, "".join(lines))


def read_history(path: Path) -> list[Round]:
    """Return the rounds of a population's evolution, oldest first; without a file, no rounds.

    Raises:
        InputError: a line of the file is not a round.
    """
    if not path.is_file():
        return []
    lines = read_bytes(path, MAX_BYTES).splitlines()
    return [_round(line, f"{path}: line {number}") for number, line in enumerate(lines, start=1)]


def _round(line: bytes, where: str) -> Round:
    return typed(Round, parse_json(line, where), f"{where} is no round of an evolution")
