"""Evaluation files (*.json): what was judged, how, and how well it did."""

from datetime import UTC, datetime
from pathlib import Path
from typing import Annotated, Literal, Self

from pydantic import Field, ValidationError, model_validator

from jaxleas.files import read_json, write_json
from jaxleas.types.errors import InputError
from jaxleas.types.strict import Strict

VERSION = 1
Fraction = Annotated[float, Field(ge=0.0, le=1.0)]
Length = Annotated[float, Field(ge=0.0)]
Count = Annotated[int, Field(ge=1)]


class AreaResult(Strict):
    """Outcomes of the starts in one start area."""

    starts: Count
    reached: Fraction
    invalid: Fraction


class CellResult(Strict):
    """Outcomes of one method in one cell; reached + invalid + stopped = 1."""

    name: str
    yaw: float
    """Heading at the start relative to the direction of crossing [deg]."""
    method: str
    """"leas_p1", "rb_lin", "rb_kino", ..."""
    planner: str | None = None
    """The exact contact planner that judged; null: the analytic conditions did."""
    starts: Count
    reached: Fraction
    """The goal (every waypoint), each configuration valid."""
    invalid: Fraction
    """An invalid configuration was met."""
    stopped: Fraction
    """Valid to the end of the episode, without reaching the goal."""
    planned: Fraction | None = None
    robustness: float | None = None
    mean_step: Length | None = None
    """Of the contact plans [m]."""
    low: Fraction
    high: Fraction
    """95 % interval (Wilson) of the main fraction."""
    expectation: Literal["cross", "stop"] = "cross"
    """"cross": the main fraction is `reached`; "stop": it is 1 - `invalid`."""
    mean_time: Length | None = None
    """To the goal, of those that reached it [s]."""
    mean_length: Length | None = None
    """Of the paths of those that reached the goal [m]."""
    detour: Length | None = None
    """Mean path length relative to straight lines, of those that reached the goal."""
    waypoints: Length | None = None
    """Mean number of waypoints between start and goal, of those that reached it by a roadmap."""
    areas: dict[str, AreaResult] = Field(default_factory=dict)
    """By start area: "near" and "far" of the transition."""

    @property
    def success(self) -> float:
        """The main fraction."""
        return self.reached if self.expectation == "cross" else 1.0 - self.invalid

    @model_validator(mode="after")
    def _adds_up(self) -> Self:
        total = self.reached + self.invalid + self.stopped
        if abs(total - 1.0) > 1e-6:
            raise ValueError(f"reached + invalid + stopped is {total:g}, not 1")
        # Fractions are written rounded: the interval may lie off by the last digit.
        if not self.low - 1e-6 <= self.success <= self.high + 1e-6:
            raise ValueError(
                f"the interval [{self.low:g}, {self.high:g}] misses its fraction {self.success:g}"
            )
        return self


class Evaluation(Strict):
    """One suite judged: the content of an evaluation file."""

    version: Literal[1] = VERSION
    suite: str
    policy: str
    """Where it was read from."""
    fingerprint: str | None = None
    """SHA-256 of its file: whether it is still the one that was judged."""
    robot: str
    seed: int
    created: str
    """ISO 8601, UTC."""
    seconds: Length | None = None
    """Wall time of the judging [s]."""
    cells: tuple[CellResult, ...]


def now() -> str:
    """Return this moment, ISO 8601, UTC."""
    return datetime.now(UTC).isoformat(timespec="seconds")


def write_evaluation(path: str | Path, evaluation: Evaluation) -> None:
    """Write an evaluation as JSON, whole or not at all."""
    write_json(path, evaluation.model_dump(mode="json"))


def read_evaluation(path: str | Path) -> Evaluation:
    """Read an evaluation.

    Raises:
        InputError: the file is missing, or a key (named) is missing, unknown or out of range.
    """
    content = read_json(path)
    if not isinstance(content, dict):
        raise InputError(f"{path} is not an evaluation: it needs an object with `suite`, `cells`")
    try:
        return Evaluation.model_validate(content)
    except ValidationError as error:
        first = error.errors()[0]
        key = ".".join(str(part) for part in first["loc"]) or "evaluation"
        raise InputError(f"{path} is not an evaluation: {key}: {first['msg']}") from error
