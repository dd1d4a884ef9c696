"""From an observation's physical units to the numbers that a network sees."""

import numpy as np
from jaxtyping import Float

from jaxleas.envs.steering.feelers import MOST_FELT
from jaxleas.envs.steering.layout import MOTION_SIZE, ObservationLayout

MOST_SURFACES = 8.0  # about the most around a robot, on rubble


def affine_scaling(
    layout: ObservationLayout, height_range: tuple[float, float], max_speed: float
) -> tuple[Float[np.ndarray, " size"], Float[np.ndarray, " size"]]:
    """Return mean and deviation that map an observation's ranges onto [-1, 1].

    They are fixed from the task's own bounds, not from data: a running normaliser shrinks the rare
    heights that matter (field notes: 89 % success instead of 98 %).
    """
    low, high = height_range
    size = layout.size
    mean, deviation = np.zeros(size, np.float32), np.full(size, max_speed, np.float32)
    deviation[3] = np.pi
    mean[MOTION_SIZE:], deviation[MOTION_SIZE:] = (low + high) / 2, (high - low) / 2
    heights_end, felt = MOTION_SIZE + layout.heights, size - len(layout.feelers)
    mean[heights_end:felt] = deviation[heights_end:felt] = 0.5 * MOST_SURFACES
    mean[felt:], deviation[felt:] = 0.0, MOST_FELT
    return mean, deviation
