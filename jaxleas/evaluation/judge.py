"""Roll out a suite and count: which roll-outs arrive, fall or stop."""

from collections.abc import Callable, Mapping

import numpy as np
from jaxtyping import Float

from jaxleas.envs.steering import SteeringEnv
from jaxleas.evaluation.exactly import judged_exactly
from jaxleas.evaluation.result_file import AreaResult, CellResult
from jaxleas.evaluation.roll_outs import CellRollOut, roll_out_cell
from jaxleas.evaluation.starts import Grounds, draw_starts, make_grounds, require_known_ground
from jaxleas.evaluation.statistics import wilson_interval
from jaxleas.evaluation.suites import Cell, Suite
from jaxleas.guide import SteeringMethod

AREA_NAMES = ("near", "far")
DIGITS = 6  # of fractions and lengths in results: exact for a million starts


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

    Raises:
        InputError: robots see maps of sensors, and no height is known around any start of a cell.
    """
    grounds = make_grounds(suite.cells) if grounds is None else grounds
    results = []
    for position, cell in enumerate(suite.cells):
        starts = draw_starts(env, grounds, cell, suite.stream())
        require_known_ground(env, grounds, cell, starts)
        for name, method in methods.items():
            progress(
                f"{suite.name} {position + 1}/{len(suite.cells)}:"
                f" {name} on {cell.name} at {cell.yaw:.0f} deg"
            )
            walked = roll_out_cell(env, grounds, method, starts, suite.steps_of(cell))
            walked = judged_exactly(env.robot, cell, walked)
            results.append(summarise(cell, name, walked, env.config.limits.time_step))
    return results


def summarise(cell: Cell, method: str, walked: CellRollOut, time_step: float) -> CellResult:
    """Count how the starts of a cell ended and measure the paths of those that arrived.

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
