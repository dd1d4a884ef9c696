"""Closed bodies of a mesh that lie inside others, as cavities do, or around them, as rooms do."""

import numpy as np
from jaxtyping import Bool, Float, Int

_DIRECTION = np.array([0.3141, 0.5772, 0.7543])  # of rays; along no edge that people draw
_MOST_NESTED = 200  # bodies inside out for which it is asked what contains them


def nested(
    corners: Float[np.ndarray, "N 3 3"],
    body: Int[np.ndarray, " N"],
    closed: Bool[np.ndarray, " B"],
    asked: Bool[np.ndarray, " B"],
) -> Bool[np.ndarray, " B"]:
    """Return which of the bodies asked for lie inside a closed one, or around one."""
    found = np.zeros(len(closed), bool)
    number = np.flatnonzero(asked)
    if not len(number) or len(number) > _MOST_NESTED or closed.sum() < 2:
        return found
    low, high = (np.full((len(closed), 3), value) for value in (np.inf, -np.inf))
    np.minimum.at(low, body, corners.min(axis=1))
    np.maximum.at(high, body, corners.max(axis=1))
    for each in number:
        around = closed & (low < low[each]).all(axis=1) & (high > high[each]).all(axis=1)
        within = closed & (low > low[each]).all(axis=1) & (high < high[each]).all(axis=1)
        own = corners[body == each]
        found[each] = any(_is_inside(own[0, 0], corners[body == b]) for b in _some(around)) or any(
            _is_inside(corners[body == b][0, 0], own) for b in _some(within)
        )
    return found


def _some(chosen: Bool[np.ndarray, " B"]) -> Int[np.ndarray, " S"]:
    return np.flatnonzero(chosen)[:_MOST_NESTED]


def _is_inside(point: Float[np.ndarray, " 3"], triangles: Float[np.ndarray, "N 3 3"]) -> bool:
    """Tell whether a ray from a point leaves a closed surface once more than it enters."""
    first, second = triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]
    across = np.cross(_DIRECTION, second)
    det = np.einsum("nk,nk->n", first, across)
    scale = np.divide(1.0, det, out=np.zeros_like(det), where=np.abs(det) > 1e-15)
    offset = point - triangles[:, 0]
    u = np.einsum("nk,nk->n", offset, across) * scale
    turned = np.cross(offset, first)
    v = turned @ _DIRECTION * scale
    distance = np.einsum("nk,nk->n", second, turned) * scale
    hits = (scale != 0.0) & (u >= 0.0) & (v >= 0.0) & (u + v <= 1.0) & (distance > 1e-9)
    return bool(hits.sum() % 2)
