"""Hulls of samples with few faces, rounded for readable files."""

import itertools

import numpy as np
from jaxtyping import Float
from scipy.spatial import ConvexHull, HalfspaceIntersection, QhullError

from jaxleas.geometry import Box, Polytope
from jaxleas.types import InputError


def simple_hull(points: Float[np.ndarray, "P 3"], within: float, what: str) -> Polytope:
    """Return a polytope of few faces around points.

    It starts from the points' bounding box, and adds the face of their hull that cuts off the worst
    corner until no corner is further than `within` outside the hull: every point lies inside.

    Args:
        points: points [m].
        within: distance [m].
        what: what the points are, for messages.

    Raises:
        InputError: the points span no volume.
    """
    try:
        corners = points[ConvexHull(points).vertices]
        hull = Polytope.from_points(corners)
        return rounded(_simplified(hull, corners, within))
    except (QhullError, ValueError, IndexError, InputError) as error:
        raise InputError(
            f"{what} spans no volume: {len(points)} samples are kept; more samples, wider limits"
            " or a wider reach would do"
        ) from error


def rounded(polytope: Polytope) -> Polytope:
    """Round for a readable file: normals to 1e-6, offsets up to the next 1e-5 m."""
    return Polytope(np.round(polytope.normals, 6) + 0.0, np.ceil(polytope.offsets * 1e5) / 1e5)


def negated(polytope: Polytope) -> Polytope:
    """Return the polytope of all -x: a foot in another one's frame, the other way around."""
    return Polytope(-polytope.normals + 0.0, polytope.offsets)


def hull_of_26(points: Float[np.ndarray, "P 3"]) -> Polytope:
    """Return the polytope around points of 26 faces, along axes, between two, and between three."""
    ways = [way for way in itertools.product((-1.0, 0.0, 1.0), repeat=3) if any(way)]
    normals = np.array(ways) / np.linalg.norm(ways, axis=1, keepdims=True)
    return rounded(Polytope(normals, (points @ normals.T).max(axis=0)))


def _simplified(hull: Polytope, corners: np.ndarray, within: float) -> Polytope:
    low, high = corners.min(axis=0), corners.max(axis=0)
    simple = Polytope.from_box(Box(tuple(low), tuple(high)))
    middle = corners.mean(axis=0)
    while True:
        halfspaces = np.concatenate([simple.normals, -simple.offsets[:, None]], axis=1)
        outer = HalfspaceIntersection(halfspaces, middle).intersections
        outside = outer @ hull.normals.T - hull.offsets
        worst, face = np.unravel_index(np.argmax(outside), outside.shape)
        if outside[worst, face] <= within:
            return simple
        simple = simple.cut(hull.normals[face : face + 1], hull.offsets[face : face + 1])
