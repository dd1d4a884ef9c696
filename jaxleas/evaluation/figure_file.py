"""The data behind the thesis's figures 4.17 and 5.6 to 5.9, as a file of plain numbers."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

from pydantic import Field

from jaxleas.conditions import STANDARD
from jaxleas.configuration import Count, Fraction, NonNegative, Positive, Strict
from jaxleas.files import read_typed, write_json


class StepRow(Strict):
    """Guide paths of one method in one cell, planned for at one in `keep_every` configurations."""

    cell: str
    method: str
    keep_every: Count
    starts: Count
    reached: Fraction
    planned: Fraction
    """Share of all starts that reached the goal with contacts planned for the whole path."""
    low: Fraction
    high: Fraction
    """95 % interval (Wilson) of `planned`."""
    undecided: Fraction | None = None
    """Share of all starts for which the planner ran out of time; counted as not planned."""
    mean_step: NonNegative | None
    """Root distance from one kept configuration to the next, over the paths that reached [m]."""
    steps: NonNegative | None
    """Mean number of those distances."""
    seconds: NonNegative | None
    """Planning time, mean over the paths that succeeded [s]."""
    slowest: NonNegative | None
    """Longest of those planning times [s]."""


class HeightBand(Strict):
    """Root heights of one method over stairs; null where fewer than half of the paths pass."""

    method: str
    guides: int
    low: tuple[float | None, ...]
    mean: tuple[float | None, ...]
    high: tuple[float | None, ...]
    clearance: NonNegative | None
    """Mean distance of the root from the ground below it [m]."""


class Course(Strict):
    """One guide path of one method along the long course, step by step."""

    method: str
    reached: bool
    planned: bool
    x: tuple[float, ...]
    """Where each step begins [m]."""
    step: tuple[float, ...]
    """Distance of the root in each step [m]."""


class Figures(Strict):
    """The content of a figure file."""

    version: Literal[1] = 1
    created: str
    planner: str
    settings: dict[str, Any]
    """Settings of the planner; `keep_every` is N_ref."""
    policies: dict[str, str]
    """SHA-256 of each policy's file, by the method's name."""
    conditions: tuple[str, ...] = STANDARD
    """Conditions that ended walks."""
    seed: int
    held_out: bool
    scale: Positive = 1.0
    """Length in the scenes for one metre of the published ones; 1 in files of earlier versions."""
    steps: tuple[StepRow, ...] = ()
    along: tuple[float, ...] = ()
    """Where the heights are taken, along the stairs [m]."""
    ground: tuple[float | None, ...] = ()
    heights: tuple[HeightBand, ...] = ()
    course_along: tuple[float, ...] = ()
    course_ground: tuple[float | None, ...] = ()
    courses: tuple[Course, ...] = Field(default=())


@dataclass(frozen=True)
class FigureFile:
    """A figure file on disk.

    Attributes:
        path: path of the file.
        figures: its content.
    """

    path: Path
    figures: Figures


def write_figures(path: str | Path, figures: Figures) -> None:
    """Write a figure file, whole or not at all."""
    write_json(path, figures.model_dump(mode="json"))


def read_figures(path: str | Path) -> Figures:
    """Read a figure file.

    Raises:
        InputError: it is not a figure file; the key that is wrong is named.
    """
    return read_typed(Figures, path, "figure file")
