"""Roll out a suite and count: which roll-outs arrive, fall or stop."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Int

from jaxleas.envs.steering import SteeringEnv
from jaxleas.evaluation.result_file import AreaResult, CellResult
from jaxleas.evaluation.starts import Grounds, Starts, draw_starts, make_grounds
from jaxleas.evaluation.statistics import wilson_interval
from jaxleas.evaluation.suites import Cell, Suite
from jaxleas.guide import SteeringMethod, Trips, roll_out
from jaxleas.types import GuidePath

AREA_NAMES = ("near", "far")
DIGITS = 6  # of fractions and lengths in results: exact for a million starts


@dataclass(frozen=True)
class CellRollOut:
    """The roll-outs of one method from the starts of one cell, on the host.

    Attributes:
        starts: starts of the roll-outs, with their goals.
        position: positions of the roots [m]; constant after the end.
        yaw: heading [rad].
        velocity: velocities of the roots [m/s].
        valid: whether each configuration satisfies the condition.
        end: index of each roll-out's last configuration.
        reached: whether the goal was reached, valid all the way.
        invalid: whether an invalid configuration was met.
        refused: whether a surrogate foresaw failure; None where none was asked.
    """

    starts: Starts
    position: Float[np.ndarray, "N T+1 3"]
    yaw: Float[np.ndarray, "N T+1"]
    velocity: Float[np.ndarray, "N T+1 3"]
    valid: Bool[np.ndarray, "N T+1"]
    end: Int[np.ndarray, " N"]
    reached: Bool[np.ndarray, " N"]
    invalid: Bool[np.ndarray, " N"]
    refused: Bool[np.ndarray, " N"] | None = None

    def path(self, index: int) -> Float[np.ndarray, "T 3"]:
        """Return the root positions of one roll-out up to its end [m]."""
        return self.position[index, : self.end[index] + 1]

    def guide_path(self, index: int, time_step: float) -> GuidePath:
        """Return one roll-out up to its end, with `time_step` [s] between configurations."""
        return GuidePath.of_walk(self, self.valid, index, time_step)[: self.end[index] + 1]


def roll_out_cell(
    env: SteeringEnv, grounds: Grounds, method: SteeringMethod, starts: Starts, steps: int
) -> CellRollOut:
    """Return the roll-outs from every start of a cell, all at once."""
    trips = Trips(grounds.atlas, starts.map_index, starts.motion, starts.waypoints)
    result = roll_out(env, method, trips, steps, env.config.goal_radius)
    return CellRollOut(
        starts=starts,
        position=np.asarray(result.position),
        yaw=np.asarray(result.yaw),
        velocity=np.asarray(result.velocity),
        valid=np.asarray(result.valid),
        end=np.asarray(result.end),
        reached=np.asarray(result.reached),
        invalid=np.asarray(result.invalid),
        refused=None if env.foresight is None else np.asarray(result.refused),
    )


def judge(
    env: SteeringEnv,
    methods: Mapping[str, SteeringMethod],
    suite: Suite,
    progress: Callable[[str], None] = lambda _: None,
    grounds: Grounds | None = None,
) -> list[CellResult]:
    """Judge steering methods on a suite: the same starts for all of them.

    Args:
        env: steering task: gives validity, the goal's radius and the time step.
        methods: steering methods by the name that results carry.
        suite: suite to be walked.
        progress: callable that is given the cell that is being walked, in words.
        grounds: height maps of the suite's scenes, if already made: suites that share them, and
            have the same numbers of starts and steps, share one compilation per method.

    Returns:
        One result per cell and method, cells in the suite's order.
    """
    grounds = make_grounds(suite.cells) if grounds is None else grounds
    results = []
    for position, cell in enumerate(suite.cells):
        starts = draw_starts(env, grounds, cell, suite.stream())
        for name, method in methods.items():
            progress(
                f"{suite.name} {position + 1}/{len(suite.cells)}:"
                f" {name} on {cell.name} at {cell.yaw:.0f} deg"
            )
            walked = roll_out_cell(env, grounds, method, starts, suite.steps_of(cell))
            results.append(summarise(cell, name, walked, env.config.limits.time_step))
    return results


def summarise(cell: Cell, method: str, walked: CellRollOut, time_step: float) -> CellResult:
    """Count the outcomes of a cell and measure the paths of those that arrived.

    Args:
        cell: cell that was walked.
        method: name of the method.
        walked: roll-outs of the cell.
        time_step: time between two configurations [s].
    """
    reached, invalid = walked.reached, walked.invalid
    count = len(reached)
    good = int(reached.sum()) if cell.expectation == "cross" else int((~invalid).sum())
    low, high = wilson_interval(good, count)
    length, straight = path_lengths(walked)
    arrived = reached & (straight > 0.0)
    fraction = rounded(reached.mean()), rounded(invalid.mean())
    return CellResult(
        name=cell.name,
        yaw=cell.yaw,
        yaw_spread=cell.yaw_spread,
        speed=cell.speed,
        method=method,
        starts=count,
        reached=fraction[0],
        invalid=fraction[1],
        stopped=rounded(1.0 - fraction[0] - fraction[1]),
        refused=None if walked.refused is None else rounded(walked.refused.mean()),
        low=rounded(low),
        high=rounded(high),
        expectation=cell.expectation,
        mean_time=_mean(walked.end[reached] * time_step),
        mean_length=_mean(length[reached]),
        detour=_mean(length[arrived] / straight[arrived]),
        areas=_areas(walked),
    )


def path_lengths(
    walked: CellRollOut,
) -> tuple[Float[np.ndarray, " N"], Float[np.ndarray, " N"]]:
    """Return how far each root went, and the straight-line length through its waypoints [m].

    The straight line goes from the start over all waypoints but the last to where the path ends:
    a roll-out ends within the goal's radius, not on the goal. Other waypoints are also only passed
    within that radius: over several of them a path may be slightly shorter than the straight line.
    """
    position = walked.position.astype(np.float64)
    steps = np.linalg.norm(np.diff(position, axis=1), axis=-1)
    before_end = np.arange(steps.shape[1]) < walked.end[:, None]
    last = position[np.arange(len(position)), walked.end]
    between = np.asarray(walked.starts.waypoints, dtype=np.float64)[:, :-1]
    corners = np.concatenate([position[:, :1], between, last[:, None]], axis=1)
    straight = np.linalg.norm(np.diff(corners, axis=1), axis=-1).sum(axis=1)
    return (steps * before_end).sum(axis=1), straight


def _areas(walked: CellRollOut) -> dict[str, AreaResult]:
    area = walked.starts.area
    if area.max() == 0:
        return {}
    return {
        name: AreaResult(
            starts=int((area == index).sum()),
            reached=rounded(walked.reached[area == index].mean()),
            invalid=rounded(walked.invalid[area == index].mean()),
        )
        for index, name in enumerate(AREA_NAMES)
    }


def _mean(values: Float[np.ndarray, " N"]) -> float | None:
    return rounded(values.mean()) if len(values) else None


def rounded(value: float | np.floating) -> float:
    """Return a fraction or length, rounded for results."""
    return abs(round(float(value), DIGITS))
