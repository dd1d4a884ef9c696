"""How noisy a map is, measured where it is flattest."""

import numpy as np

from jaxleas.terrain.planes.windows import Windows

FLATTEST = 25.0
"""Percentage of windows, the flattest ones, in which noise alone is at work."""
LEAST_NOISE = 0.003
"""Smallest standard deviation that heights are given [m]: no foot feels less."""


def measured_noise(windows: Windows, most: float) -> float:
    """Return the standard deviation of the heights about the planes of the flattest windows [m].

    Args:
        windows: planes fitted in small windows.
        most: largest standard deviation of what still is a surface [m].
    """
    from scipy.stats import chi2

    deviation = windows.deviation[np.isfinite(windows.deviation)]
    if not deviation.size:
        return LEAST_NOISE
    low = np.percentile(deviation, FLATTEST)
    expected = np.sqrt(chi2.ppf(FLATTEST / 100.0, windows.freedom) / windows.freedom)
    return float(np.clip(low / expected, LEAST_NOISE, max(most, LEAST_NOISE)))
