"""Unit quaternions (w, x, y, z) of any batch, in NumPy."""

import numpy as np
from jaxtyping import Float

IDENTITY = (1.0, 0.0, 0.0, 0.0)


def quaternion_about_z(yaw: Float[np.ndarray, "*batch"] | float) -> Float[np.ndarray, "*batch 4"]:
    """Return the quaternion of a turn about the vertical.

    Args:
        yaw: angle to turn by, counter-clockwise seen from above [rad].
    """
    half = 0.5 * np.asarray(yaw, dtype=np.float64)
    zero = np.zeros_like(half)
    return np.stack([np.cos(half), zero, zero, np.sin(half)], axis=-1)


def matrix_of(quaternion: Float[np.ndarray, "*batch 4"]) -> Float[np.ndarray, "*batch 3 3"]:
    """Return the rotation matrix of a unit quaternion."""
    w, x, y, z = (quaternion[..., index] for index in range(4))
    rows = [
        [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)],
        [2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)],
        [2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)],
    ]
    return np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)


def quaternion_of(matrix: Float[np.ndarray, "*batch 3 3"]) -> Float[np.ndarray, "*batch 4"]:
    """Return the unit quaternion of a rotation matrix, with w >= 0.

    The entries of the symmetric matrix 4 q q^T are sums of the rotation's entries; the longest
    of its columns is used, so that no half turn is ill-conditioned.
    """
    m = np.asarray(matrix, dtype=np.float64)
    trace = m[..., 0, 0] + m[..., 1, 1] + m[..., 2, 2]
    outer = np.empty((*m.shape[:-2], 4, 4))
    outer[..., 0, 0] = 1.0 + trace
    for one, (two, three) in enumerate(((1, 2), (2, 0), (0, 1))):
        outer[..., one + 1, one + 1] = 1.0 + 2.0 * m[..., one, one] - trace
        outer[..., 0, one + 1] = outer[..., one + 1, 0] = m[..., three, two] - m[..., two, three]
        mixed = m[..., one, two] + m[..., two, one]
        outer[..., one + 1, two + 1] = outer[..., two + 1, one + 1] = mixed
    longest = np.diagonal(outer, axis1=-2, axis2=-1).argmax(axis=-1)[..., None, None]
    column = np.take_along_axis(outer, longest, axis=-1)[..., 0]
    unit = column / np.linalg.norm(column, axis=-1, keepdims=True)
    return np.where(unit[..., :1] < 0.0, -unit, unit)


def multiply(
    first: Float[np.ndarray, "*batch 4"], second: Float[np.ndarray, "*batch 4"]
) -> Float[np.ndarray, "*batch 4"]:
    """Return the quaternion that turns by `second`, then by `first`."""
    w, v = first[..., :1], first[..., 1:]
    u, t = second[..., :1], second[..., 1:]
    real = w * u - (v * t).sum(axis=-1, keepdims=True)
    return np.concatenate([real, w * t + u * v + np.cross(v, t)], axis=-1)
