"""Small matrices inside compiled loops: in place, on the lower triangle.

Needs numba; only the compiled solver imports it.
"""

from typing import Any

import numba
import numpy as np

_FLOOR = (
    1e-15  # a pivot that keeps less of its diagonal entry is rounding: its direction is left out
)
_TINY = 1e-300

_REORDER = {"reassoc", "contract", "nsz"}  # not `nnan`: broken programs must be seen


def compiled(function: Any) -> Any:
    """Compile a function that releases Python's lock; the machine code is kept between runs."""
    return numba.njit(cache=True, error_model="numpy", nogil=True)(function)


def vectorised(function: Any) -> Any:
    """Compile a function whose sums may be taken in any order, so that they run in vectors."""
    return numba.njit(cache=True, error_model="numpy", nogil=True, fastmath=_REORDER)(function)


@compiled
def factor_in_place(matrix: np.ndarray) -> float:
    """Replace a matrix by its lower factor, the diagonal inverted; return the least pivot."""
    least = np.inf
    for i in range(len(matrix)):
        for k in range(i + 1):
            value = matrix[i, k]
            for j in range(k):
                value -= matrix[i, j] * matrix[k, j]
            if i == k:
                least = min(least, value)
                is_left = value > _FLOOR * abs(matrix[i, i]) + _TINY
                matrix[i, i] = 1.0 / np.sqrt(value) if is_left else 0.0
            else:
                matrix[i, k] = value * matrix[k, k]
    return least


@compiled
def solve_forwards(factor: np.ndarray, right: np.ndarray) -> None:
    """Replace b by the solution of L v = b."""
    for i in range(len(right)):
        value = right[i]
        for j in range(i):
            value -= factor[i, j] * right[j]
        right[i] = value * factor[i, i]


@compiled
def solve_backwards(factor: np.ndarray, right: np.ndarray) -> None:
    """Replace b by the solution of L^T v = b."""
    for i in range(len(right) - 1, -1, -1):
        value = right[i]
        for j in range(i + 1, len(right)):
            value -= factor[j, i] * right[j]
        right[i] = value * factor[i, i]


@compiled
def add_wrench(wrench: np.ndarray, arm: np.ndarray, force: np.ndarray, sign: float) -> None:
    """Add a force and its torque, times a sign, to a wrench."""
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        wrench[i] += sign * force[i]
        wrench[3 + i] += sign * (arm[j] * force[k] - arm[k] * force[j])


@compiled
def pulled_back(arm: np.ndarray, wrench: np.ndarray, axis: int) -> float:
    """Return an entry of the transpose of `add_wrench`."""
    j, k = (axis + 1) % 3, (axis + 2) % 3
    return wrench[axis] + wrench[3 + j] * arm[k] - wrench[3 + k] * arm[j]


@compiled
def times_symmetric(matrix: np.ndarray, vector: np.ndarray, found: np.ndarray) -> None:
    """Write a symmetric 3 x 3 matrix, (00, 10, 11, 20, 21, 22), times a vector."""
    x, y, z = vector[0], vector[1], vector[2]
    found[0] = matrix[0] * x + matrix[1] * y + matrix[3] * z
    found[1] = matrix[1] * x + matrix[2] * y + matrix[4] * z
    found[2] = matrix[3] * x + matrix[4] * y + matrix[5] * z


@compiled
def invert_symmetric(matrix: np.ndarray) -> None:
    """Replace a symmetric 3 x 3 matrix, (00, 10, 11, 20, 21, 22), by its inverse."""
    # By its factors, not by cofactors: they cancel where a force lies at an edge of its pyramid.
    a, b, d = matrix[0], matrix[1] / matrix[0], matrix[3] / matrix[0]
    c = matrix[2] - b * matrix[1]
    e = (matrix[4] - d * matrix[1]) / c
    f = matrix[5] - d * matrix[3] - e * e * c
    low = b * e - d
    p, q, r = 1.0 / a, 1.0 / c, 1.0 / f
    matrix[0] = p + b * b * q + low * low * r
    matrix[1] = -b * q - e * low * r
    matrix[2] = q + e * e * r
    matrix[3] = low * r
    matrix[4] = -e * r
    matrix[5] = r


@compiled
def add_gram(matrix: np.ndarray, arm: np.ndarray, soft: np.ndarray) -> None:
    """Add E S E^T, lower triangle, of one point with the wrench E and the symmetric matrix S."""
    x, y, z = arm[0], arm[1], arm[2]
    a, b, c = soft[0], soft[1], soft[2]
    d, e, f = soft[3], soft[4], soft[5]
    p0, p1, p2 = y * d - z * b, y * e - z * c, y * f - z * e
    q0, q1, q2 = z * a - x * d, z * b - x * e, z * d - x * f
    r0, r1, r2 = x * b - y * a, x * c - y * b, x * e - y * d
    matrix[0, 0] += a
    matrix[1, 0] += b
    matrix[1, 1] += c
    matrix[2, 0] += d
    matrix[2, 1] += e
    matrix[2, 2] += f
    matrix[3, 0] += p0
    matrix[3, 1] += p1
    matrix[3, 2] += p2
    matrix[4, 0] += q0
    matrix[4, 1] += q1
    matrix[4, 2] += q2
    matrix[5, 0] += r0
    matrix[5, 1] += r1
    matrix[5, 2] += r2
    matrix[3, 3] += y * p2 - z * p1
    matrix[4, 3] += y * q2 - z * q1
    matrix[4, 4] += z * q0 - x * q2
    matrix[5, 3] += y * r2 - z * r1
    matrix[5, 4] += z * r0 - x * r2
    matrix[5, 5] += x * r1 - y * r0
