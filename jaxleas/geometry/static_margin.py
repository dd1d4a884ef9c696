"""How far a point lies inside the polygon of the feet in contact."""

import numpy as np
from jaxtyping import Bool, Float

AROUND = (0, 2, 3, 1)
"""The feet counter-clockwise, seen from above: LF, LH, RH, RF."""


def distance_inside(
    points: Float[np.ndarray, "*#batch 2"],
    feet: Float[np.ndarray, "*#batch 4 2"],
    standing: Bool[np.ndarray, "*#batch 4"],
) -> Float[np.ndarray, "*batch"]:
    """Return the distance of points from the nearest side of the feet's polygon; outside below 0.

    At rest on level ground, a centre of mass above such a point is in equilibrium.

    Args:
        points: points [m].
        feet: feet, which never cross [m].
        standing: feet in contact: all of them, or all but one.
    """
    corner, stands = feet[..., AROUND, :], standing[..., AROUND]
    follower = np.roll(corner, -1, axis=-2)
    # Where the next foot swings, the side goes to the one after it.
    over = np.roll(corner, -2, axis=-2)
    follower = np.where(np.roll(stands, -1, axis=-1)[..., None], follower, over)
    side = follower - corner
    length = np.hypot(side[..., 0], side[..., 1]) + 1e-9
    apart = points[..., None, :] - corner
    inside = (side[..., 0] * apart[..., 1] - side[..., 1] * apart[..., 0]) / length
    return np.where(stands, inside, np.inf).min(axis=-1)
