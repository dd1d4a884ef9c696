"""C: no ground inside the trunk, or above it (T 3.3.1, eq. 3.5)."""

from dataclasses import dataclass
from functools import reduce
from typing import Self

import jax.numpy as jnp
import numpy as np
from jax import Array
from jaxtyping import Float

from jaxleas.conditions.condition import MARGIN_LIMIT, Condition
from jaxleas.conditions.points import columns_of
from jaxleas.robots import Robot
from jaxleas.types import InputError, RootMotion

_TOLERANCE = 1e-6  # points on a box's edge count as under it [m]


@dataclass(frozen=True, eq=False, init=False)
class Collision:
    """C: the ground under every point stays below the trunk.

    With bottom_i the underside of the lowest trunk box over point i, the margin is
    min_i (bottom_i - height_i)  (T eq. 3.5), in metres. A single-layer map cannot distinguish
    ground inside the trunk from a ceiling above it: both are collisions. Without ground there is no
    collision.

    Attributes:
        points_in_root: points under the trunk [m].
        bottoms: index of each point, and height of the underside over it [m].
    """

    points_in_root: Float[np.ndarray, "P 2"]
    bottoms: tuple[tuple[int, float], ...]

    def __init__(
        self, robot: Robot, candidates: Float[np.ndarray, "C 2"], padding: float = 0.0
    ) -> None:
        """Keep the candidates that lie under the trunk.

        Args:
            robot: robot whose trunk must be free.
            candidates: points whose heights are sampled anyway [m].
            padding: length by which each box's rectangle is enlarged [m].

        Raises:
            InputError: the padding is negative, or no candidate lies under the trunk.
        """
        if not 0.0 <= padding < np.inf:
            raise InputError(f"collision padding must be zero or more metres, got {padding}")
        bottoms = trunk_bottoms(robot, candidates, padding)
        kept = bottoms < np.inf
        if not kept.any():
            raise InputError(
                f"none of the {len(candidates)} grid points lies under the trunk of {robot.name}; "
                "collision needs points near the root"
            )
        vars(self).update(
            points_in_root=candidates[kept], bottoms=tuple(enumerate(map(float, bottoms[kept])))
        )

    def __call__(
        self, heights_in_root: Float[Array, "*batch P"], motion: RootMotion
    ) -> Float[Array, "*batch"]:
        """Return the margin of the condition [m]."""
        del motion
        # One term per point: see reachability.
        margins = [bottom - heights_in_root[..., index] for index, bottom in self.bottoms]
        return jnp.clip(reduce(jnp.minimum, margins), -MARGIN_LIMIT, MARGIN_LIMIT)

    def read_from(self, points: Float[np.ndarray, "Q 2"]) -> Self:
        """Return the same condition for the heights at further points."""
        columns = columns_of(self.points_in_root, points)
        moved = object.__new__(type(self))
        bottoms = tuple((int(columns[index]), bottom) for index, bottom in self.bottoms)
        vars(moved).update(points_in_root=points, bottoms=bottoms)
        return moved


def collision(robot: Robot, points: Float[np.ndarray, "P 2"], padding: float = 0.0) -> Condition:
    """Return C for the heights at all of `points`, including those that it does not need.

    Args:
        robot: robot whose trunk must be free.
        points: points in the root frame [m], in the order of the heights.
        padding: length by which each box's rectangle is enlarged [m].

    Raises:
        InputError: the padding is negative, or no point lies under the trunk.
    """
    return Collision(robot, points, padding).read_from(points)


def trunk_bottoms(
    robot: Robot, points: Float[np.ndarray, "P 2"], padding: float = 0.0
) -> Float[np.ndarray, " P"]:
    """Return the underside of the lowest trunk box over each point [m]; infinity for no box."""
    bottoms = np.full(len(points), np.inf)
    for box in robot.trunk:
        low, high = np.asarray(box.low[:2]), np.asarray(box.high[:2])
        enlarged = padding + _TOLERANCE
        under = np.all((points >= low - enlarged) & (points <= high + enlarged), axis=-1)
        bottoms[under] = np.minimum(bottoms[under], box.low[2])
    return bottoms
