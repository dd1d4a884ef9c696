"""Sets of points in the root frame: their union, and the indices of one set in another."""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Float, Int

from jaxleas.types import InputError

Points = Float[np.ndarray, "P 2"]
"""Points in the root frame [m]."""


def union_of_points(several: Sequence[Points], order: Points | None = None) -> Points:
    """Return the points of several sets, each once.

    Args:
        several: sets of points in the root frame [m].
        order: points that set the order of the union, as far as it lies among them [m]; other
            points follow in the order of the sets.
    """
    wanted = {_key(point): point for points in several for point in points}
    first = [wanted.pop(_key(point)) for point in _none_if(order) if _key(point) in wanted]
    return np.array([*first, *wanted.values()], dtype=np.float64).reshape(-1, 2)


def extended(points: Points, further: Points) -> Points:
    """Return `points`, followed by those of `further` that are not among them."""
    known = {_key(point) for point in points}
    new = [point for point in union_of_points([further]) if _key(point) not in known]
    return np.concatenate([points, np.array(new).reshape(-1, 2)]) if new else points


def columns_of(wanted: Points, points: Points) -> Int[np.ndarray, " wanted"]:
    """Return the index of each of `wanted` in `points`.

    Raises:
        InputError: one of them is missing.
    """
    places: dict[tuple[float, ...], int] = {}
    for index, point in enumerate(points):
        places.setdefault(_key(point), index)
    missing = [point for point in wanted if _key(point) not in places]
    if missing:
        x, y = missing[0]
        raise InputError(
            f"the condition reads the point ({x:g}, {y:g}) m, which is not among the {len(points)}"
            " points whose heights are known"
        )
    return np.array([places[_key(point)] for point in wanted], dtype=np.int64)


def _key(point: np.ndarray) -> tuple[float, ...]:
    return tuple(float(value) + 0.0 for value in point)  # -0.0 is 0.0


def _none_if(points: Points | None) -> Points:
    return np.zeros((0, 2)) if points is None else points
