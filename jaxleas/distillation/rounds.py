"""The rounds of a distillation: what each leaves, and the table of them all."""

import shutil
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any, Protocol

from jaxleas.distillation.folder import DistillationFolder, RoundFolder
from jaxleas.distillation.rounds_file import VERSION
from jaxleas.files import atomic_path, write_json
from jaxleas.training.policy import SteeringPolicy
from jaxleas.training.train_state import Learned

Say = Callable[[str], None]


@dataclass(frozen=True)
class Practised:
    """What a round of practice ends with.

    Attributes:
        policy: to be judged.
        learned: what the next round begins with.
        labels: guide paths judged for it.
        seconds: spent, by stage.
        surrogate: what its fit measured; None where there is none.
    """

    policy: SteeringPolicy
    learned: Learned
    labels: int = 0
    seconds: dict[str, float] = field(default_factory=dict)
    surrogate: dict[str, Any] | None = None


class Mode(Protocol):
    """How a policy practises against its planner in one round."""

    def practise(self, number: int, before: Practised, say: Say) -> Practised:
        """Return what the round ends with; what is in its folder is not done again."""
        ...

    def products(self, folder: RoundFolder) -> list[Path]:
        """Return the files of a round that are its result."""
        ...


@dataclass(frozen=True)
class RoundResult:
    """One row of the table.

    Attributes:
        round: its number; 0 is the policy begun with.
        success: mean exact success over all cells.
        cells: exact success of each cell.
        labels: guide paths judged in this round.
        seconds: spent on labels, fit, practice and judgement.
        surrogate: what its fit measured; None in round 0.
    """

    round: int
    success: float
    cells: dict[str, float]
    labels: int
    seconds: dict[str, float]
    surrogate: dict[str, Any] | None


def best_of(results: Sequence[RoundResult]) -> RoundResult:
    """Return the round of most success, the first of several."""
    return max(results, key=lambda result: (result.success, -result.round))


def keep_rounds(folder: DistillationFolder, results: Sequence[RoundResult], mode: Mode) -> None:
    """Write the table, and put what the best round of practice made at hand."""
    rounds = [asdict(each) for each in results]
    write_json(folder.table, {"version": VERSION, "rounds": rounds})
    for file in mode.products(folder.round(best_of(results[1:]).round)):
        with atomic_path(folder.path / file.name) as temporary:
            shutil.copyfile(file, temporary)
