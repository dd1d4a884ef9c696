"""Falls: when a robot no longer walks, and by what it is seen."""

from typing import Literal, get_args

import numpy as np
from jaxtyping import Float, Int

from jaxleas.physics import Body, BodyState, Sensed

Fall = Literal["tilted", "low", "diverged"]
"""What shows that a robot fell: its trunk is tilted, or low over its feet; or its numbers are no
longer finite, which is a failure of the simulation."""
FALLS: tuple[Fall, ...] = get_args(Fall)
TILT = np.deg2rad(50.0)
"""Greatest angle between the trunk's and the world's vertical [rad]."""
LOWEST = 0.5
"""Least height of the trunk over the middle of its feet, over that of standing [1]."""
UPRIGHT = -1
"""What `falls` returns for a robot that did not fall."""


def falls(body: Body, state: BodyState, sensed: Sensed) -> Int[np.ndarray, " N"]:
    """Return the index of each robot's fall among `FALLS`, `UPRIGHT` where it walks."""
    x, y = state.quaternion[:, 1], state.quaternion[:, 2]
    with np.errstate(invalid="ignore"):
        upright = 1.0 - 2.0 * (x * x + y * y)  # of the trunk's vertical axis
        standing = LOWEST * (body.standing_height - body.foot_radius)
        height = _height(state.position, sensed.feet)
        found = [
            ~np.isfinite(state.coordinates).all(axis=1) | ~np.isfinite(state.speeds).all(axis=1),
            upright < np.cos(TILT),
            height < standing,
        ]
    kinds = [FALLS.index("diverged"), FALLS.index("tilted"), FALLS.index("low")]
    return np.select(found, kinds, default=UPRIGHT)


def _height(
    position: Float[np.ndarray, "N 3"], feet: Float[np.ndarray, "N E 3"]
) -> Float[np.ndarray, " N"]:
    return position[:, 2] - feet[..., 2].mean(axis=1)
