"""Swings: where a foot in the air is to be, and the force that brings it there."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float


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

    They move by the quintic that begins and ends at rest, s^3 (10 - 15 s + 6 s^2), and rise above
    the line between its ends by the apex times 64 s^3 (1 - s)^3, half of the way.

    Args:
        lift_off: where the feet left the ground [m].
        touchdown: where they are to meet it [m].
        progress: how much of the swing is done, 0 to 1.
        duration: duration of a swing [s].
        apex: greatest height above the line from lift-off to touchdown [m].
    """
    s = progress[..., None]
    rest = 1.0 - s
    way = s**3 * (10.0 - 15.0 * s + 6.0 * s * s)
    speed = 30.0 * (s * rest) ** 2 / duration
    push = 60.0 * s * rest * (1.0 - 2.0 * s) / duration**2
    product = s * rest
    rise = 64.0 * apex * product**3
    rising = 192.0 * apex * product**2 * (1.0 - 2.0 * s) / duration
    bending = 192.0 * apex * product * (2.0 * (1.0 - 2.0 * s) ** 2 - 2.0 * product) / duration**2
    gone = touchdown - lift_off
    up = np.array([0.0, 0.0, 1.0])
    return FootTarget(
        lift_off + way * gone + rise * up, speed * gone + rising * up, push * gone + bending * up
    )
