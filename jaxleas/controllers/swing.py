"""Swings: where a foot in the air is to be, and the force that brings it there."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

RISES_FIRST = 0.2
"""Share of a swing in which a foot only rises: one that stands before an edge gets over it."""


@dataclass(frozen=True, eq=False)
class FootTarget:
    """Where feet are to be.

    Attributes:
        place: position in the world [m].
        velocity: velocity in the world [m/s].
        acceleration: acceleration in the world [m/s2].
    """

    place: Float[np.ndarray, "N E 3"]
    velocity: Float[np.ndarray, "N E 3"]
    acceleration: Float[np.ndarray, "N E 3"]


def swing_target(
    lift_off: Float[np.ndarray, "N E 3"],
    touchdown: Float[np.ndarray, "N E 3"],
    progress: Float[np.ndarray, "N E"],
    duration: float,
    apex: float,
) -> FootTarget:
    """Return where feet are to be on their way from lift-off to touchdown.

    They rise above the line between its ends by the apex times 64 s^3 (1 - s)^3, and move along it
    by the quintic that begins and ends at rest, s^3 (10 - 15 s + 6 s^2), whose s begins later.

    Args:
        lift_off: where the feet left the ground [m].
        touchdown: where they are to meet it [m].
        progress: how much of the swing is done, 0 to 1.
        duration: duration of a swing [s].
        apex: greatest height above the line from lift-off to touchdown [m].
    """
    s = progress[..., None]
    rest = 1.0 - s
    ahead = np.maximum(s - RISES_FIRST, 0.0) / (1.0 - RISES_FIRST)
    lasts = (1.0 - RISES_FIRST) * duration
    way = ahead**3 * (10.0 - 15.0 * ahead + 6.0 * ahead * ahead)
    speed = 30.0 * (ahead * (1.0 - ahead)) ** 2 / lasts
    push = 60.0 * ahead * (1.0 - ahead) * (1.0 - 2.0 * ahead) / lasts**2
    product = s * rest
    rise = 64.0 * apex * product**3
    rising = 192.0 * apex * product**2 * (1.0 - 2.0 * s) / duration
    bending = 192.0 * apex * product * (2.0 * (1.0 - 2.0 * s) ** 2 - 2.0 * product) / duration**2
    gone = touchdown - lift_off
    up = np.array([0.0, 0.0, 1.0])
    return FootTarget(
        lift_off + way * gone + rise * up, speed * gone + rising * up, push * gone + bending * up
    )
