"""Swings that rise above what is on their way, and then fall: where a foot in the air is to be."""

import numpy as np
from jaxtyping import Float

from jaxleas.controllers.swing import FootTarget

RISEN, FALLS = 0.4, 0.6
"""Shares of a swing at which a foot is at its top, and at which it begins to fall."""
LEAVES, ARRIVES = 0.2, 0.8
"""Shares of a swing between which it moves horizontally: it clears an edge beside which it
stood."""


def high_swing(
    lift_off: Float[np.ndarray, "N E 3"],
    touchdown: Float[np.ndarray, "N E 3"],
    top: Float[np.ndarray, "N E"],
    progress: Float[np.ndarray, "N E"],
    duration: Float[np.ndarray, "N E"],
) -> FootTarget:
    """Return where feet are to be: up, across and down, each by the quintic between two rests.

    Args:
        lift_off: where the feet left the ground [m].
        touchdown: where they are to meet it [m].
        top: height to which they rise [m].
        progress: how much of the swing is done, 0 to 1.
        duration: duration of the swing [s].
    """
    up, across, down = (
        _between(progress, duration, *span)
        for span in ((0.0, RISEN), (LEAVES, ARRIVES), (FALLS, 1.0))
    )
    gone = touchdown - lift_off
    rise, fall = top - lift_off[..., 2], top - touchdown[..., 2]
    place, velocity, push = (
        np.concatenate(
            [
                across[order][..., None] * gone[..., :2],
                (rise * up[order] - fall * down[order])[..., None],
            ],
            axis=-1,
        )
        for order in range(3)
    )
    return FootTarget(lift_off + place, velocity, push)


def _between(
    progress: Float[np.ndarray, "N E"], duration: Float[np.ndarray, "N E"], begin: float, end: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return s^3 (10 - 15 s + 6 s^2) between two shares of a swing, and its two derivatives."""
    s = ((progress - begin) / (end - begin)).clip(0.0, 1.0)
    lasts = (end - begin) * duration
    rest = s * (1.0 - s)
    return (
        s**3 * (10.0 - 15.0 * s + 6.0 * s * s),
        30.0 * rest**2 / lasts,
        60.0 * rest * (1.0 - 2.0 * s) / lasts**2,
    )
