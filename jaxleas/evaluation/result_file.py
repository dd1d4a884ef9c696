"""Evaluation files (*.json): what was judged, how, and how well it did."""

from datetime import UTC, datetime
from pathlib import Path
from typing import Any, Literal, Self

from pydantic import Field, model_validator

from jaxleas.conditions import STANDARD
from jaxleas.configuration import Count, Fraction, NonNegative, Positive, Strict
from jaxleas.envs.steering import GuardConfig
from jaxleas.files import read_typed, write_json
from jaxleas.terrain import CellCount, NoiseConfig

VERSION = 1


class AreaResult(Strict):
    """Results of the starts in one start area."""

    starts: Count
    reached: Fraction
    invalid: Fraction


class CellResult(Strict):
    """Results of one method in one cell; reached + invalid + stopped = 1."""

    name: str
    yaw: float
    """Heading at the start relative to the direction of crossing [deg]."""
    yaw_spread: NonNegative = 0.0
    """Headings are uniform in `yaw` +- this, to either side [deg]."""
    speed: NonNegative = 0.0
    """Speed at the start, along the heading [m/s]."""
    method: str
    """"leas_p1", "rb_lin", "rb_kino", ..."""
    planner: str | None = None
    """Exact contact planner that judged; null: the analytic conditions did."""
    starts: Count
    reached: Fraction
    """Share that reached the goal (every waypoint), each configuration valid."""
    invalid: Fraction
    """Share that met an invalid configuration."""
    stopped: Fraction
    """Share valid to the end of the episode, without reaching the goal."""
    refused: Fraction | None = None
    """Share stopped because a surrogate foresaw failure; null where none was asked."""
    planned: Fraction | None = None
    """Share that reached the goal with contacts planned for the whole guide path."""
    robustness: float | None = None
    """Mean robustness over the postures of a contact plan, mean over successful plans [N]."""
    mean_step: NonNegative | None = None
    """Root distance per step, mean over the plans that succeeded [m]."""
    undecided: Fraction | None = None
    """Share for which the planner ran out of time; counted as not planned."""
    low: Fraction
    high: Fraction
    """95 % interval (Wilson) of the main fraction."""
    expectation: Literal["cross", "stop"] = "cross"
    """"cross": the main fraction is `planned` where a planner judged, else `reached`; "stop": it
    is 1 - `invalid`."""
    mean_time: NonNegative | None = None
    """Mean time to the goal, over the roll-outs that reached it [s]."""
    mean_length: NonNegative | None = None
    """Mean path length, over the roll-outs that reached the goal [m]."""
    detour: NonNegative | None = None
    """Mean path length relative to straight lines, over the roll-outs that reached the goal."""
    waypoints: NonNegative | None = None
    """Mean number of waypoints between start and goal, over those that reached it by a roadmap."""
    areas: dict[str, AreaResult] = Field(default_factory=dict)
    """Results by start area: "near" and "far" from the transition."""

    @property
    def success(self) -> float:
        """Return the main fraction."""
        if self.expectation == "stop":
            return 1.0 - self.invalid
        return self.reached if self.planned is None else self.planned

    @model_validator(mode="after")
    def _adds_up(self) -> Self:
        if (self.planned is None) != (self.planner is None):
            raise ValueError("`planned` and `planner` go together")
        if self.planned is not None and self.planned > self.reached + 1e-6:
            raise ValueError(f"planned is {self.planned:g}, more than the {self.reached:g} reached")
        total = self.reached + self.invalid + self.stopped
        if abs(total - 1.0) > 1e-6:
            raise ValueError(f"reached + invalid + stopped is {total:g}, not 1")
        # Fractions are written rounded: the interval may be off by the last digit.
        if not self.low - 1e-6 <= self.success <= self.high + 1e-6:
            raise ValueError(
                f"the interval [{self.low:g}, {self.high:g}] misses its fraction {self.success:g}"
            )
        return self


class MapCells(Strict):
    """What became of the cells with ground in maps from sensors, as shares of them."""

    missing: Fraction
    """Share whose height was missing."""
    filled: Fraction
    """Share that was filled from the rims of its gap."""
    unknown: Fraction
    """Share whose height stayed unknown; it is seen as no ground."""

    @classmethod
    def of(cls, count: CellCount | None) -> Self | None:
        """Return counted cells, rounded; None where robots see the terrain itself."""
        if count is None:
            return None
        shares = {name: round(float(value), 6) for name, value in vars(count).items()}
        return cls(**shares)


class Evaluation(Strict):
    """One suite judged: the content of an evaluation file."""

    version: Literal[1] = VERSION
    suite: str
    policy: str
    """Path that the policy was read from."""
    fingerprint: str | None = None
    """SHA-256 of the policy's file, to check that it is still the one that was judged."""
    policies: dict[str, str] = Field(default_factory=dict)
    """SHA-256 of the file of each further policy or method of one's own, by the method's name."""
    planners: dict[str, dict[str, Any]] = Field(default_factory=dict)
    """Settings of the exact planners, by name."""
    conditions: tuple[str, ...] = STANDARD
    """Conditions that ended walks."""
    foresight: dict[str, Any] | None = None
    """Refusal of guide paths foreseen to fail: `surrogate` (SHA-256 of its file), `planner`,
    `threshold`."""
    guard: GuardConfig | None = None
    """Guard of the policy's walks, which further policies share only if theirs is the same; null in
    files of earlier versions."""
    noise: NoiseConfig | None = None
    """What was wrong with the maps that robots saw; null: they saw the terrain itself."""
    map_cells: MapCells | None = None
    """Cells of these maps, counted; null without noise."""
    robot: str
    scale: Positive = 1.0
    """Length in the scenes for one metre of the published ones; 1 in files of earlier versions."""
    seed: int
    created: str
    """Time of the judging, ISO 8601, UTC."""
    seconds: NonNegative | None = None
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
    return read_typed(Evaluation, path, "evaluation", VERSION)
