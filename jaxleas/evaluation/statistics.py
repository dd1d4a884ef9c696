"""Confidence intervals of measured fractions."""

import math

from jaxleas.types import InputError

NORMAL_95 = 1.959963984540054
"""Two-sided 95 % quantile of the standard normal distribution."""


def wilson_interval(successes: int, count: int, z: float = NORMAL_95) -> tuple[float, float]:
    """Return the Wilson score interval of a fraction: accurate near 0 and 1, where ours lie.

    centre = (p + z^2 / 2n) / (1 + z^2 / n), half = z / (1 + z^2 / n) sqrt(p q / n + z^2 / 4n^2)

    Args:
        successes: number of successes, p = successes / count.
        count: number of trials, n, at least 1.
        z: quantile of the normal distribution; 95 % by default.

    Returns:
        Lower and upper end, in [0, 1].

    Raises:
        InputError: the numbers do not give a fraction.

    Source: E. B. Wilson, Probable inference, the law of succession, and statistical inference,
    JASA 22 (1927).
    """
    if count < 1 or not 0 <= successes <= count:
        raise InputError(f"{successes} successes of {count} trials are no fraction")
    fraction, square = successes / count, z * z / count
    centre = (fraction + 0.5 * square) / (1.0 + square)
    spread = fraction * (1.0 - fraction) / count + 0.25 * square / count
    half = z * math.sqrt(spread) / (1.0 + square)
    # At the ends the interval closes exactly; rounding must not move it off them.
    low = 0.0 if successes == 0 else max(0.0, centre - half)
    high = 1.0 if successes == count else min(1.0, centre + half)
    return low, high
