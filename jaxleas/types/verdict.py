"""An exact planner's verdict on one guide path."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Verdict:
    """What an exact planner made of one guide path.

    Attributes:
        path: number of the guide path in its file, or in the call.
        decided: whether it is a verdict at all: False where the time limit came first, or the
            planner broke; such a path is neither a success nor a failure.
        success: whether the planner reached the last configuration.
        last_index: of the last configuration of the guide path reached; -1 if not even the first.
        length: configurations of the guide path.
        reached: share of the kept configurations that was reached.
        steps: contacts made after the start.
        mean_step: way of the root up to `last_index` for each step [m]; None without step.
        repositions: of the steps, those made without going on; None where the planner has none.
        least_robustness: of all postures [N]; None without posture, or where not computed.
        mean_robustness: likewise.
        undecided: steps that SL1M's relaxation left without surface; None for other planners.
        combinations: of surfaces that SL1M tried; None likewise.
        reason: what stopped the planner, a sentence; empty on success.
        seconds: spent planning.
    """

    path: int
    decided: bool
    success: bool
    last_index: int
    length: int
    reached: float
    steps: int
    mean_step: float | None
    repositions: int | None
    least_robustness: float | None
    mean_robustness: float | None
    undecided: int | None
    combinations: int | None
    reason: str
    seconds: float
