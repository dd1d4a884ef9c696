"""R and R*: can some leg stand on the ground? (T 3.3.1, eq. 3.4 and 3.6)."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import reduce
from typing import Self

import jax.numpy as jnp
import numpy as np
from jax import Array
from jaxtyping import Bool, Float

from jaxleas.conditions.condition import MARGIN_LIMIT, Condition
from jaxleas.conditions.footprint import is_under_root
from jaxleas.conditions.points import columns_of
from jaxleas.robots import Robot
from jaxleas.types import InputError, RootMotion

Interval = tuple[int, float, float]
"""Index of a point, and z interval of a leg's range of motion over it [m]."""


@dataclass(frozen=True, eq=False, init=False)
class Reachability:
    """R: some point lies inside the range of motion of some leg.

    With [low_il, high_il] the z interval of leg l's range of motion over point i, cut once, the
    margin is  max_i max_l min(height_i - low_il, high_il - height_i)  (T eq. 3.4), in metres.

    Attributes:
        points_in_root: points that lie over a range of motion [m].
        intervals: intervals of each leg over the points.
    """

    points_in_root: Float[np.ndarray, "P 2"]
    intervals: tuple[Interval, ...]

    def __init__(self, robot: Robot, candidates: Float[np.ndarray, "C 2"]) -> None:
        """Keep the candidates that the condition needs.

        Args:
            robot: robot whose legs reach.
            candidates: points whose heights are sampled anyway [m].

        Raises:
            InputError: no candidate that it considers lies over any leg's range of motion.
        """
        considered = candidates[self._counts(candidates)]
        reaches = [limb.range_of_motion.z_interval(considered) for limb in robot.legs]
        kept = np.any([np.isfinite(low) for low, _ in reaches], axis=0)
        if not kept.any():
            raise InputError(
                f"none of the {len(considered)} grid points considered lies over a leg's range of "
                f"motion of {robot.name}; reachability needs points near the root"
            )
        intervals = tuple(
            (index, float(low), float(high))
            for lows, highs in reaches
            for index, (low, high) in enumerate(zip(lows[kept], highs[kept], strict=True))
            if np.isfinite(low)
        )
        vars(self).update(points_in_root=considered[kept], intervals=intervals)

    def __call__(
        self, heights_in_root: Float[Array, "*batch P"], motion: RootMotion
    ) -> Float[Array, "*batch"]:
        """Return the margin of the condition [m]."""
        del motion
        return _margin(self.intervals, heights_in_root)

    def read_from(self, points: Float[np.ndarray, "Q 2"]) -> Self:
        """Return the same condition for the heights at further points."""
        columns = columns_of(self.points_in_root, points)
        moved = object.__new__(type(self))
        intervals = tuple((int(columns[i]), low, high) for i, low, high in self.intervals)
        vars(moved).update(points_in_root=points, intervals=intervals)
        return moved

    @staticmethod
    def _counts(points: Float[np.ndarray, "C 2"]) -> Bool[np.ndarray, " C"]:
        return np.ones(len(points), dtype=bool)


class StrictReachability(Reachability):
    """R*: as `Reachability`, with i over the points under the root alone (T eq. 3.6).

    A robot that stands beside the ground rather than above it is refused.
    """

    @staticmethod
    def _counts(points: Float[np.ndarray, "C 2"]) -> Bool[np.ndarray, " C"]:
        return is_under_root(points)


def reachability(robot: Robot, points: Float[np.ndarray, "P 2"]) -> Condition:
    """Return R for the heights at all of `points`, including those that it does not need.

    Args:
        robot: robot whose legs reach.
        points: points in the root frame [m], in the order of the heights.

    Raises:
        InputError: no point lies over any leg's range of motion.
    """
    return Reachability(robot, points).read_from(points)


def strict_reachability(robot: Robot, points: Float[np.ndarray, "P 2"]) -> Condition:
    """Return R* for the heights at all of `points`, including those that it does not need.

    Args:
        robot: robot whose legs reach.
        points: points in the root frame [m], in the order of the heights.

    Raises:
        InputError: no point under the root lies over a leg's range of motion.
    """
    return StrictReachability(robot, points).read_from(points)


def _margin(
    intervals: Sequence[Interval], heights: Float[Array, "*batch P"]
) -> Float[Array, "*batch"]:
    # One term per interval: XLA fuses such slices; a gather costs 20 times as much (CPU).
    margins = [
        jnp.minimum(heights[..., index] - low, high - heights[..., index])
        for index, low, high in intervals
    ]
    return jnp.clip(reduce(jnp.maximum, margins), -MARGIN_LIMIT, MARGIN_LIMIT)
