"""What a round came to, and which of several was best."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

_CONFIDENCE = 1.96  # standard deviations: 95 %


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
        starts: judged in all cells together; 0 where it is not known.
        robustness: of the plans, mean over the cells [N]; None where the planner has none.
    """

    round: int
    success: float
    cells: dict[str, float]
    labels: int
    seconds: dict[str, float]
    surrogate: dict[str, Any] | None
    starts: int = 0
    robustness: float | None = None


def best_of(results: Sequence[RoundResult]) -> RoundResult:
    """Return the round of most success; where chance may have put it first, the most robust.

    Two rounds are alike where a test of two proportions does not tell them apart at 95 %: another
    draw of starts might have put the other one first.
    """
    first = max(results, key=lambda each: (each.success, -each.round))
    alike = [each for each in results if each is first or _are_alike(first, each)]
    return max(alike, key=lambda each: (each.robustness or 0.0, each.success, -each.round))


def _are_alike(first: RoundResult, other: RoundResult) -> bool:
    if not first.starts or not other.starts:
        return False
    successes = first.success * first.starts + other.success * other.starts
    share = successes / (first.starts + other.starts)
    variance = share * (1.0 - share) * (1.0 / first.starts + 1.0 / other.starts)
    return first.success - other.success <= _CONFIDENCE * math.sqrt(variance)
