"""The history of a population: who took over from whom, and when."""

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from jaxleas.files import write_text
from jaxleas.sweeps.evolution import Succession


class History:
    """`history.jsonl`: one line a round of evolution: scores, parents and values of all members."""

    def __init__(self, path: Path, after_step: int) -> None:
        """Go on with the rounds up to a step; later ones belong to an abandoned future."""
        self.path = path
        self._rows = [row for row in read_history(path) if row["step"] <= after_step]
        self._write()

    def append(self, step: int, scores: list[float], round_: list[Succession]) -> None:
        """Add a round; a score of nothing is a member that made non-finite numbers."""
        finite = [each if np.isfinite(each) else None for each in scores]
        self._rows.append(
            {
                "step": step,
                "scores": finite,
                "parents": [each.parent for each in round_],
                "values": [each.values for each in round_],
            }
        )
        self._write()

    def _write(self) -> None:
        if self._rows or self.path.is_file():
            lines = [json.dumps(row, allow_nan=False) + "\n" for row in self._rows]
            write_text(self.path, "".join(lines))


def read_history(path: Path) -> list[dict[str, Any]]:
    """Return the rounds of a population's evolution, oldest first; none where there is no file."""
    if not path.is_file():
        return []
    return [json.loads(line) for line in path.read_text(encoding="utf-8").splitlines()]


def lineage(history: Sequence[dict[str, Any]], member: int) -> list[int]:
    """Return whose weights a member had before each round, oldest first, and its own number."""
    line = [member]
    for row in reversed(history):
        line.append(row["parents"][line[-1]])
    return line[::-1]
