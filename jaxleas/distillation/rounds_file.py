"""`rounds.json`, the table of a distillation's rounds, checked before a report is made of it."""

from pathlib import Path
from typing import Annotated, Any, Self

from pydantic import BaseModel, Field, model_validator

from jaxleas.files import read_json, require_version, typed
from jaxleas.types.bounds import Count, Fraction, NonNegative, Whole
from jaxleas.types.errors import InputError

VERSION = 1


class _Confusion(BaseModel):
    """Verdicts against what was foreseen."""

    threshold: Fraction
    failed_foreseen: Whole
    failed_unforeseen: Whole
    passed_foreseen: Whole
    passed_unforeseen: Whole


class _Part(BaseModel):
    """What a surrogate is worth, by stretch or by guide path."""

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


class _Rounds(BaseModel):
    rounds: Annotated[list[_Row], Field(min_length=1)]

    @model_validator(mode="after")
    def _same_cells(self) -> Self:
        if any(row.cells.keys() != self.rounds[0].cells.keys() for row in self.rounds):
            raise ValueError("rounds were judged in different cells")
        return self


def read_rounds(path: Path) -> list[dict[str, Any]]:
    """Return the rows of a table of rounds, round 0 first, as they stand in the file.

    Raises:
        InputError: the file is none.
    """
    content = read_json(path)
    if not isinstance(content, dict):
        raise InputError(f"{path} holds no `rounds`")
    require_version(content, VERSION, path)
    typed(_Rounds, content, f"{path} holds no rounds of a distillation")
    return content["rounds"]
