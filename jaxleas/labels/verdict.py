"""An exact planner's verdict on one guide path."""

from dataclasses import asdict, dataclass
from typing import Any

from jaxleas.types.errors import InputError


@dataclass(frozen=True)
class Verdict:
    """What an exact planner made of one guide path.

    Attributes:
        path: number of the guide path in its file.
        success: whether the planner reached the last configuration.
        last_index: of the last configuration reached; -1 if not even the first.
        length: configurations of the guide path.
        reached: share of the kept configurations that was reached.
        steps: contacts made after the start.
        repositions: of those, made without going on.
        least_robustness: of all postures [N]; None without posture.
        mean_robustness: likewise.
        reason: what stopped the planner, a sentence; empty on success.
        seconds: spent planning.
    """

    path: int
    success: bool
    last_index: int
    length: int
    reached: float
    steps: int
    repositions: int
    least_robustness: float | None
    mean_robustness: float | None
    reason: str
    seconds: float


def verdict_to_json(verdict: Verdict) -> dict[str, Any]:
    """Return a verdict as JSON has it."""
    return asdict(verdict)


def verdict_from_json(value: Any, where: str) -> Verdict:
    """Return the verdict that JSON holds.

    Raises:
        InputError: it is none; `where` names it.
    """
    names = set(Verdict.__dataclass_fields__)
    if not isinstance(value, dict) or set(value) != names:
        raise InputError(f"{where} is no verdict: it needs the keys {', '.join(sorted(names))}")
    return Verdict(**value)
