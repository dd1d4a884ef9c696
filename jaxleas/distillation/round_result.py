"""The results of a round, and which of several rounds was best."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class RoundResult:
    """One row of the table.

    Attributes:
        round: number of the round; 0 is the policy begun with.
        success: mean exact success over all cells.
        cells: exact success of each cell.
        labels: number of guide paths judged in this round.
        seconds: time spent on labels, fit, practice and judgement [s].
        surrogate: measurements of the surrogate's fit; None in round 0.
        starts: number of starts judged in all cells together; 0 where it is not known.
        robustness: robustness of the plans, mean over the cells [N]; None where the planner does
            not report it.
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
    """Return the round of most success; among comparable rounds, the most robust.

    Rounds whose success is less than a standard error below the greatest are comparable to it:
    another draw of starts might have put them first.
    """
    most = max(result.success for result in results)
    starts = min(result.starts for result in results)
    error = math.sqrt(most * (1.0 - most) / starts) if starts else 0.0
    alike = [result for result in results if result.success >= most - error]
    return max(alike, key=lambda each: (each.robustness or 0.0, each.success, -each.round))
