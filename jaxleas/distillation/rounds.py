"""The rounds of a distillation: the results of each, and the table of them all."""

import shutil
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Protocol

from jaxleas.distillation.folder import DistillationFolder, RoundFolder
from jaxleas.distillation.round_result import RoundResult, best_of
from jaxleas.distillation.rounds_file import read_rounds, write_rounds
from jaxleas.files import atomic_path
from jaxleas.training import Learned, Policy


class Say(Protocol):
    """Shows what is being done."""

    def __call__(self, words: str, *, passing: bool = False) -> None:
        """Show a sentence.

        Args:
            words: sentence to show.
            passing: whether it is one of many in a row, of which some may be left out.
        """
        ...


@dataclass(frozen=True)
class Practised:
    """The result of a round of practice.

    Attributes:
        policy: policy to be judged.
        learned: networks that the next round begins with.
        labels: number of guide paths judged for the round.
        seconds: time spent, by stage [s].
        surrogate: measurements of the surrogate's fit; None without a surrogate.
    """

    policy: Policy
    learned: Learned
    labels: int = 0
    seconds: dict[str, float] = field(default_factory=dict)
    surrogate: dict[str, Any] | None = None


class Mode(Protocol):
    """How a policy practises against its planner in one round."""

    def practise(self, number: int, before: Practised, say: Say) -> Practised:
        """Return the result of the round; what is already in its folder is not done again."""
        ...

    def products(self, folder: RoundFolder) -> list[Path]:
        """Return the files of a round that are its result."""
        ...


def known_rounds(folder: DistillationFolder) -> dict[int, RoundResult]:
    """Return the rounds that an earlier session judged, with the time they took, by number."""
    if not folder.table.is_file():
        return {}
    rows = {each.round: each for each in read_rounds(folder.table)}
    return {number: row for number, row in rows.items() if folder.round(number).judged.is_file()}


def keep_rounds(folder: DistillationFolder, results: Sequence[RoundResult], mode: Mode) -> None:
    """Write the table, and copy the products of the best round to the top of the folder."""
    write_rounds(folder.table, results)
    for file in mode.products(folder.round(best_of(results[1:]).round)):
        with atomic_path(folder.path / file.name) as temporary:
            shutil.copyfile(file, temporary)
