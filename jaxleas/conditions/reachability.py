"""R and R*: can some leg stand on the ground? (T 3.3.1, eq. 3.4 and 3.6)."""

from functools import reduce

import jax.numpy as jnp
import numpy as np
from jax import Array
from jaxtyping import Float

from jaxleas.conditions.condition import MARGIN_LIMIT, Condition
from jaxleas.conditions.footprint import is_under_root
from jaxleas.robots import Robot
from jaxleas.types import InputError, RootMotion


def reachability(robot: Robot, points: Float[np.ndarray, "P 2"]) -> Condition:
    """Return R: some grid point lies inside the range of motion of some leg.

    With [low_il, high_il] the z interval of leg l's range of motion over point i, cut once here,
    the margin is  max_i max_l min(height_i - low_il, high_il - height_i)  (T eq. 3.4).

    Args:
        robot: whose legs.
        points: of the grid in the root frame [m], in the order of the heights.

    Returns:
        The condition; its margin is in metres of height.

    Raises:
        InputError: no point lies over any leg's range of motion.
    """
    return _reach(robot, points, np.arange(len(points)))


def strict_reachability(robot: Robot, points: Float[np.ndarray, "P 2"]) -> Condition:
    """Return R*: some grid point directly under the root lies inside a range of motion.

    As `reachability`, with i over the points under the root alone (T eq. 3.6): a robot that stands
    beside the ground rather than above it is refused.

    Args:
        robot: whose legs.
        points: of the grid in the root frame [m], in the order of the heights.

    Returns:
        The condition; its margin is in metres of height.

    Raises:
        InputError: no point under the root lies over a leg's range of motion.
    """
    return _reach(robot, points, np.flatnonzero(is_under_root(points)))


def _reach(robot: Robot, points: Float[np.ndarray, "P 2"], considered: np.ndarray) -> Condition:
    intervals = [
        (int(index), float(low), float(high))
        for limb in robot.limbs
        for index, low, high in zip(
            considered, *limb.range_of_motion.z_interval(points[considered]), strict=True
        )
        if np.isfinite(low)
    ]
    if not intervals:
        raise InputError(
            f"none of the {len(considered)} grid points considered lies over a leg's range of "
            f"motion of {robot.name}; reachability needs points near the root"
        )

    def judge(
        heights_in_root: Float[Array, "*batch P"], motion: RootMotion
    ) -> Float[Array, "*batch"]:
        del motion
        # One term an interval: XLA fuses such slices, where a gather costs 20 times as much (CPU).
        margins = [
            jnp.minimum(heights_in_root[..., index] - low, high - heights_in_root[..., index])
            for index, low, high in intervals
        ]
        return jnp.clip(reduce(jnp.maximum, margins), -MARGIN_LIMIT, MARGIN_LIMIT)

    return judge
