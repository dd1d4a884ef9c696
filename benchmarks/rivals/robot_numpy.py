"""The robot's shape over the points around it, in NumPy, from plain numbers."""

from typing import Any

import numpy as np

UNDER_ROOT = 0.1 + 1e-6  # half side of the square under the root [m]
EDGE = 1e-6  # points on the edge of a trunk box count as under it [m]


def footprint(trunk: list[dict[str, list[float]]]) -> np.ndarray:
    """Return points over the lowest trunk box, its edges included, about 11 x 10 cm apart."""
    box = min(trunk, key=lambda each: each["low"][2])
    lines = []
    for axis, spacing in enumerate((0.112, 0.101)):
        length = box["high"][axis] - box["low"][axis]
        count = int(np.ceil(length / spacing - 1e-6)) + 1
        lines.append([box["low"][axis] + length * i / (count - 1) for i in range(count)])
    return np.array([(x, y) for x in lines[0] for y in lines[1]])


def reach_intervals(
    limbs: list[dict[str, Any]], points: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return points under the root, one entry per leg, and the range of z that it reaches there."""
    found = []
    for index in np.flatnonzero(np.all(np.abs(points) <= UNDER_ROOT, axis=1)):
        for limb in limbs:
            low, high = -np.inf, np.inf
            for normal, offset in zip(limb["normals"], limb["offsets"], strict=True):
                left = offset - normal[0] * points[index, 0] - normal[1] * points[index, 1]
                if abs(normal[2]) <= 1e-12:
                    low = low if left >= 0.0 else np.inf
                elif normal[2] > 0.0:
                    high = min(high, left / normal[2])
                else:
                    low = max(low, left / normal[2])
            if low <= high:
                found.append((index, low, high))
    indices, lows, highs = zip(*found, strict=True)
    return np.array(indices), np.array(lows, np.float32), np.array(highs, np.float32)


def trunk_bottoms(
    trunk: list[dict[str, list[float]]], points: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return which points lie under the trunk, and the height of its underside there."""
    found = []
    for index, (x, y) in enumerate(points):
        over = [
            box["low"][2]
            for box in trunk
            if box["low"][0] - EDGE <= x <= box["high"][0] + EDGE
            and box["low"][1] - EDGE <= y <= box["high"][1] + EDGE
        ]
        if over:
            found.append((index, min(over)))
    indices, bottoms = zip(*found, strict=True)
    return np.array(indices), np.array(bottoms, np.float32)
