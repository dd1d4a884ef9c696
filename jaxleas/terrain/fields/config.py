"""What fields are drawn with: sizes of gaps, stones, steps and plates."""

from typing import Annotated, Self

from pydantic import Field, model_validator

from jaxleas.configuration import Positive, Strict

Range = tuple[Positive, Positive]


class FieldConfig(Strict):
    """Sizes of a field and of what is on it; ranges are [least, most]."""

    length: Annotated[float, Field(ge=3.0, le=40.0)] = 8.0
    """Side along which sections follow each other [m]."""
    width: Annotated[float, Field(ge=2.0, le=40.0)] = 4.0
    """Side across [m]."""
    resolution: Annotated[float, Field(ge=0.01, le=0.04)] = 0.02
    """Side of a cell [m]: a foot needs 5 cm around it."""
    platform: Range = (0.7, 1.4)
    """Length of level ground between two sections [m]."""
    gap: Range = (0.05, 0.3)
    """Width of a gap [m]."""
    stone: Range = (0.22, 0.35)
    """Side of a stepping stone [m]."""
    stone_gap: Range = (0.04, 0.12)
    """Distance of neighbouring stones [m]."""
    stone_rise: Positive = 0.03
    """Largest height of a stone above or below the platforms [m]."""
    stones: Range = (1.0, 2.2)
    """Length of a row of stones [m]."""
    riser: Range = (0.04, 0.08)
    """Height of a step [m]."""
    tread: Range = (0.36, 0.5)
    """Depth of a step [m]."""
    plate: Positive = 1.0
    """Side of a plate of random stairs [m] (D sec. IV-A)."""
    plate_slope: Positive = 0.05
    """Rise from a plate to the next, along and across [m]."""
    plate_rise: Positive = 0.05
    """Largest height of a plate above or below that slope [m]."""

    @model_validator(mode="after")
    def _ordered(self) -> Self:
        for name in ("platform", "gap", "stone", "stone_gap", "stones", "riser", "tread"):
            low, high = getattr(self, name)
            if low > high:
                raise ValueError(f"{name} = [{low:g}, {high:g}] must be [least, most]")
        return self

    def cells(self, length: float) -> int:
        """Return the number of cells that a length covers, one at least."""
        return max(1, round(length / self.resolution))

    @property
    def shape(self) -> tuple[int, int]:
        """Rows (across) and columns (along)."""
        return self.cells(self.width), self.cells(self.length)
