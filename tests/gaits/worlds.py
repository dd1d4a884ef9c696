"""Small terrains for gaits, as height maps in frames of their own."""

import numpy as np

from jaxleas.terrain import HeightMap

CELL = 0.02


def platform(length: float = 3.0, width: float = 1.6) -> HeightMap:
    """Return level ground whose middle is at (1, 2) m, 0.5 m high."""
    rows, columns = round(width / CELL), round(length / CELL)
    heights = np.full((rows, columns), 0.5, np.float32)
    return HeightMap(heights, CELL, (1.0 - 0.5 * length, 2.0 - 0.5 * width))


def with_gap(gap: float, **size: float) -> HeightMap:
    """Return the platform with a gap across its middle."""
    level = platform(**size)
    half = round(0.5 * gap / CELL)
    middle = level.shape[1] // 2
    heights = level.heights.copy()
    heights[:, middle - half : middle + half] = np.nan
    return HeightMap(heights, level.resolution, level.origin)
