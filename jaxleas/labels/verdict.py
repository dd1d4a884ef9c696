"""An exact planner's verdict on one guide path."""

from dataclasses import asdict, dataclass, fields
from functools import cache
from typing import Any

from pydantic import BaseModel, ValidationError, create_model

from jaxleas.types import GuidePath
from jaxleas.types.errors import InputError


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
    try:
        _model().model_validate(value, strict=True)
    except ValidationError as error:
        first = error.errors()[0]
        key = ".".join(map(str, first["loc"]))
        raise InputError(f"{where} is no verdict: {key}: {first['msg']}") from error
    return Verdict(**value)


@cache
def _model() -> type[BaseModel]:
    """Return what checks the types: a dataclass by itself takes anything."""
    return create_model("Verdict", **{each.name: (each.type, ...) for each in fields(Verdict)})  # type: ignore[call-overload]


def mean_step(path: GuidePath, last_index: int, steps: int) -> float | None:
    """Return the way of the root up to a configuration for each step [m]; None without step."""
    if steps < 1:
        return None
    return path[: last_index + 1].length / steps
