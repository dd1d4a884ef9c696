"""Bezier curves of which one control point is free: each point is constant + share * free point.

c(s) = sum_k B_k(s) (constant_k + share_k x). Velocities and accelerations are affine in x, too, and
so is c x (c'' - g), since x x x = 0 (Fernbach et al. 2020, "C-CROC", sec. IV).
"""

from functools import cache
from math import comb
from typing import Any, NamedTuple

import numpy as np
from jaxtyping import Float

from jaxleas.dynamics.croc.transitions import BoundaryState, Numbers


class AffinePoints(NamedTuple):
    """Points in space that depend on the free point x: constant + share x.

    Attributes:
        constant: the points for x = 0.
        share: factors of x.
    """

    constant: Float[Numbers, "*batch K 3"]
    share: Float[Numbers, "*batch K"]

    def through(self, matrix: Numbers) -> "AffinePoints":
        """Return the points that the rows of a matrix combine."""
        return AffinePoints(
            matrix @ self.constant,
            (matrix @ self.share[..., None])[..., 0],
        )


def namespace(array: Numbers) -> Any:
    """Return the library of an array: NumPy, or JAX's."""
    return array.__array_namespace__()


def cross_product(
    first: Float[Numbers, "*batch 3"], second: Float[Numbers, "*batch 3"]
) -> Float[Numbers, "*batch 3"]:
    """Return first x second, of NumPy or of JAX; leading axes broadcast."""
    a, b, c = first[..., 0], first[..., 1], first[..., 2]
    x, y, z = second[..., 0], second[..., 1], second[..., 2]
    return namespace(first).stack([b * z - c * y, c * x - a * z, a * y - b * x], axis=-1)


def free_curve(
    start: BoundaryState, end: BoundaryState, total: Float[Numbers, "*batch"], degree: int
) -> AffinePoints:
    """Return the control points of the centre of mass's curve.

    Args:
        start: state at time 0.
        end: state at the end.
        total: duration of the curve [s].
        degree: 4 or 6.
    """
    xp = namespace(total)
    step = total[..., None] / degree
    c0, v0, a0 = start
    c1, v1, a1 = end
    free = xp.zeros_like(c0)
    if degree == 4:
        points = [c0, c0 + v0 * step, free, c1 - v1 * step, c1]
    else:
        bend = step * step * (degree / (degree - 1.0))
        points = [c0, c0 + v0 * step, c0 + 2.0 * v0 * step + a0 * bend, free]
        points += [c1 - 2.0 * v1 * step + a1 * bend, c1 - v1 * step, c1]
    share = np.zeros(degree + 1)
    share[degree // 2] = 1.0
    shape = (*total.shape, degree + 1)
    return AffinePoints(
        xp.stack(points, axis=-2), xp.broadcast_to(xp.asarray(share, dtype=total.dtype), shape)
    )


def acceleration_of(curve: AffinePoints, total: Float[Numbers, "*batch"]) -> AffinePoints:
    """Return the control points of the second derivative [m/s^2].

    Args:
        curve: control points of the position.
        total: duration of the curve [s].
    """
    degree = curve.share.shape[-1] - 1
    scale = degree * (degree - 1) / (total * total)
    bent = curve.constant[..., 2:, :] - 2.0 * curve.constant[..., 1:-1, :]
    bent = bent + curve.constant[..., :-2, :]
    share = curve.share[..., 2:] - 2.0 * curve.share[..., 1:-1] + curve.share[..., :-2]
    return AffinePoints(scale[..., None, None] * bent, scale[..., None] * share)


def bernstein(degree: int, at: Float[Numbers, "*batch L"]) -> Float[Numbers, "*batch L K"]:
    """Return the Bernstein polynomials of a degree at fractions of the curve."""
    xp = namespace(at)
    terms = [
        comb(degree, k) * at**k * (1.0 - at) ** (degree - k)  # 0 ** 0 is 1
        for k in range(degree + 1)
    ]
    return xp.stack(terms, axis=-1)


def restriction(
    degree: int, begin: Float[Numbers, "*batch"], end: Float[Numbers, "*batch"]
) -> Float[Numbers, "*batch K K"]:
    """Return the matrix from a curve's control points to those of its part between two fractions.

    Its row k is the blossom of the curve at k times `end` and degree - k times `begin`.
    """
    xp = namespace(begin)
    identity = xp.broadcast_to(
        xp.eye(degree + 1, dtype=begin.dtype), (*begin.shape, degree + 1, degree + 1)
    )
    rows = []
    for k in range(degree + 1):
        points = identity
        for at in [begin] * (degree - k) + [end] * k:
            u = at[..., None, None]
            points = (1.0 - u) * points[..., :-1, :] + u * points[..., 1:, :]
        rows.append(points[..., 0, :])
    return xp.stack(rows, axis=-2)


@cache
def elevation(degree: int, to: int) -> Float[np.ndarray, "M K"]:
    """Return the matrix from control points to those of the same curve with a higher degree."""
    matrix = np.eye(degree + 1)
    for now in range(degree, to):
        fraction = np.arange(now + 2)[:, None] / (now + 1.0)
        padded = np.pad(matrix, ((1, 1), (0, 0)))
        matrix = fraction * padded[:-1] + (1.0 - fraction) * padded[1:]
    return matrix


@cache
def product(degree: int) -> Float[np.ndarray, "M K A"]:
    """Return the tensor of c x (c'' - g): from control points of both to those of the product.

    The factors have the degrees n and n - 2; the product has 2 n - 3, since the leading terms of c
    and of c'' are parallel.
    """
    first, second = degree, degree - 2
    whole = first + second
    tensor = np.zeros((whole + 1, first + 1, second + 1))
    for i in range(first + 1):
        for j in range(second + 1):
            tensor[i + j, i, j] = comb(first, i) * comb(second, j) / comb(whole, i + j)
    lowered = np.linalg.pinv(elevation(whole - 1, whole))
    return np.einsum("mk,kij->mij", lowered, tensor)
