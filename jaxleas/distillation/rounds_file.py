"""`rounds.json`, the table of a distillation's rounds: written, and validated when read."""

from collections.abc import Sequence
from dataclasses import asdict, fields
from pathlib import Path
from typing import Annotated, Self

from pydantic import BaseModel, Field, model_validator

from jaxleas.configuration import Count, Fraction, NonNegative, Whole
from jaxleas.distillation.round_result import RoundResult
from jaxleas.files import read_json, require_version, typed, write_json
from jaxleas.types import InputError

VERSION = 1


class _Confusion(BaseModel):
    """Verdicts against predictions."""

    threshold: Fraction
    failed_foreseen: Whole
    failed_unforeseen: Whole
    passed_foreseen: Whole
    passed_unforeseen: Whole


class _Part(BaseModel):
    """Quality of a surrogate, by stretch or by guide path."""

    count: Count
    failed: Whole
    balanced_accuracy: Fraction
    area_under_curve: Fraction
    calibration_error: Fraction
    log_loss: NonNegative
    log_loss_of_the_share: NonNegative
    confusion: _Confusion
    curve: Annotated[list[tuple[Fraction, Fraction, NonNegative]], Field(min_length=1)]


class _Report(BaseModel):
    stretch: _Part
    guide: _Part


class _Row(BaseModel):
    round: Whole
    success: Fraction
    cells: Annotated[dict[str, Fraction], Field(min_length=1)]
    labels: Whole
    seconds: dict[str, NonNegative]
    surrogate: _Report | None
    starts: Whole = 0
    robustness: float | None = None


class _Rounds(BaseModel):
    rounds: Annotated[list[_Row], Field(min_length=1)]

    @model_validator(mode="after")
    def _same_cells(self) -> Self:
        if any(row.cells.keys() != self.rounds[0].cells.keys() for row in self.rounds):
            raise ValueError("rounds were judged in different cells")
        return self


def write_rounds(path: Path, results: Sequence[RoundResult]) -> None:
    """Write the table of all rounds."""
    write_json(path, {"version": VERSION, "rounds": [asdict(each) for each in results]})


def read_rounds(path: Path) -> list[RoundResult]:
    """Return the rows of a table of rounds, round 0 first.

    Raises:
        InputError: the file is not a table of rounds.
    """
    content = read_json(path)
    if not isinstance(content, dict):
        raise InputError(f"{path} holds no `rounds`")
    require_version(content, VERSION, path)
    typed(_Rounds, content, f"{path} holds no rounds of a distillation")
    names = [each.name for each in fields(RoundResult)]
    return [
        RoundResult(**{name: row[name] for name in names if name in row})
        for row in content["rounds"]
    ]
