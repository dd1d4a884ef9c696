"""Random lengths of a given sum: the depths of steps, the sides of rubble."""

import numpy as np
from jaxtyping import Float


def split(
    rng: np.random.Generator, total: float, count: int, interval: tuple[float, float]
) -> Float[np.ndarray, " count"]:
    """Return `count` random lengths that sum to `total`, each in the interval if possible.

    Random lengths are scaled to the total, then moved towards equal ones until all fit.
    """
    drawn = rng.uniform(*interval, size=count)
    spread = drawn * (total / drawn.sum()) - total / count
    room = np.where(spread > 0.0, interval[1] - total / count, total / count - interval[0])
    scale = np.divide(room, np.abs(spread), out=np.ones(count), where=np.abs(spread) > 1e-12)
    return total / count + spread * float(np.clip(scale.min(), 0.0, 1.0))
