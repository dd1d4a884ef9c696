"""C: no ground inside the trunk, or above it (T 3.3.1, eq. 3.5)."""

from functools import reduce

import jax.numpy as jnp
import numpy as np
from jax import Array
from jaxtyping import Float

from jaxleas.conditions.condition import MARGIN_LIMIT, Condition
from jaxleas.robots import Robot
from jaxleas.types import InputError, RootMotion

_TOLERANCE = 1e-6  # [m]: points on a box's edge count as under it


def collision(robot: Robot, points: Float[np.ndarray, "P 2"], padding: float = 0.0) -> Condition:
    """Return C: the ground under every grid point stays below the trunk.

    With bottom_i the underside of the lowest trunk box over point i, the margin is
    min_i (bottom_i - height_i)  (T eq. 3.5). A single-layer map cannot tell ground inside the trunk
    from a ceiling above it: both are collisions. No ground, no collision.

    Args:
        robot: whose trunk.
        points: of the grid in the root frame [m], in the order of the heights.
        padding: by which each box's rectangle is enlarged [m].

    Returns:
        The condition; its margin is in metres of height.

    Raises:
        InputError: padding is negative, or no point lies under the trunk.
    """
    if not 0.0 <= padding < np.inf:
        raise InputError(f"collision padding must be zero or more metres, got {padding}")
    bottoms = trunk_bottoms(robot, points, padding)
    under_trunk = [
        (int(index), float(bottoms[index])) for index in np.flatnonzero(bottoms < np.inf)
    ]
    if not under_trunk:
        raise InputError(
            f"none of the {len(points)} grid points lies under the trunk of {robot.name}; "
            "collision needs points near the root"
        )

    def judge(
        heights_in_root: Float[Array, "*batch P"], motion: RootMotion
    ) -> Float[Array, "*batch"]:
        del motion
        # One term a point: see reachability.
        margins = [bottom - heights_in_root[..., index] for index, bottom in under_trunk]
        return jnp.clip(reduce(jnp.minimum, margins), -MARGIN_LIMIT, MARGIN_LIMIT)

    return judge


def trunk_bottoms(
    robot: Robot, points: Float[np.ndarray, "P 2"], padding: float = 0.0
) -> Float[np.ndarray, " P"]:
    """Return the underside of the lowest trunk box over each point [m], infinity where none is."""
    bottoms = np.full(len(points), np.inf)
    for box in robot.trunk:
        low, high = np.asarray(box.low[:2]), np.asarray(box.high[:2])
        enlarged = padding + _TOLERANCE
        under = np.all((points >= low - enlarged) & (points <= high + enlarged), axis=-1)
        bottoms[under] = np.minimum(bottoms[under], box.low[2])
    return bottoms
