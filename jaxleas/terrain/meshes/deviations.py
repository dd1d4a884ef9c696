"""How far many polygons are from planar and convex: `polygons.py`, for all of as many corners."""

import numpy as np
from jaxtyping import Float

from jaxleas.terrain.areas import area_vectors

_BATCH = 5_000_000  # pairs of an edge and a vertex at a time, to save memory


def planarity_deviations(polygons: Float[np.ndarray, "N V 3"]) -> Float[np.ndarray, " N"]:
    """Return the largest distances of vertices from the planes through the centroids [m]."""
    rest = polygons - polygons.mean(axis=1, keepdims=True)
    return np.abs(np.einsum("nvk,nk->nv", rest, _normals(polygons))).max(axis=1)


def convexity_deviations(polygons: Float[np.ndarray, "N V 3"]) -> Float[np.ndarray, " N"]:
    """Return the largest distances of vertices outside an edge's half-plane [m]; 0 if convex."""
    found = np.zeros(len(polygons))
    step = max(1, _BATCH // polygons.shape[1] ** 2)
    for start in range(0, len(polygons), step):
        some = polygons[start : start + step]
        edges = np.roll(some, -1, axis=1) - some
        inward = np.cross(_normals(some)[:, None], edges)
        inward /= np.maximum(np.linalg.norm(inward, axis=2, keepdims=True), 1e-12)
        own = np.einsum("nek,nek->ne", inward, some)
        distance = np.einsum("nek,nvk->nev", inward, some) - own[:, :, None]
        found[start : start + step] = np.maximum(0.0, -distance.min(axis=(1, 2)))
    return found


def _normals(polygons: Float[np.ndarray, "N V 3"]) -> Float[np.ndarray, "N 3"]:
    area = area_vectors(polygons)
    return area / np.maximum(np.linalg.norm(area, axis=1, keepdims=True), 1e-12)
