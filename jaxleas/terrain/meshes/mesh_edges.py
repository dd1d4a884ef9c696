"""Edges of a mesh, the bodies that its faces make across them, and which of these are closed.

Faces that share an edge are wound alike if they pass it in opposite directions. A body is closed if
its faces pass each edge as often one way as the other.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Int

WELD = 1e-5
"""Distance below which vertices are merged [m]."""
_MIXED = np.array([1, 2_654_435_761_123, 40_503_001_777_211])
"""Multiples of coordinates whose sum, past the largest integer, tells points apart."""


def welded(
    triangles: Float[np.ndarray, "T 3 3"],
) -> tuple[Float[np.ndarray, "P 3"], Int[np.ndarray, "N 3"]]:
    """Return the vertices of triangles, each once, and the triangles that keep three of them."""
    corners = triangles.reshape(-1, 3)
    first, index = _distinct(np.round(corners / WELD).astype(np.int64))
    faces = index.reshape(-1, 3)
    whole = (faces[:, 0] != faces[:, 1]) & (faces[:, 1] != faces[:, 2])
    whole &= faces[:, 2] != faces[:, 0]
    return corners[first], faces[whole]


def _distinct(
    points: Int[np.ndarray, "C 3"],
) -> tuple[Int[np.ndarray, " P"], Int[np.ndarray, " C"]]:
    """Return where each different point comes first, and which of these each point is."""
    with np.errstate(over="ignore"):
        key = points @ _MIXED
    _, first, index = np.unique(key, return_index=True, return_inverse=True)
    if not np.array_equal(points[first[index]], points):  # two points with the same key
        _, first, index = np.unique(points, axis=0, return_index=True, return_inverse=True)
    order = np.argsort(first)  # as in the file: neighbours lie near each other in memory
    number = np.empty(len(order), np.int32)
    number[order] = np.arange(len(order))
    return first[order], number[index.reshape(-1)]


@dataclass(frozen=True)
class Edges:
    """The edges on the sides of faces: side 3 f + k of face f begins at its corner k.

    Attributes:
        number: number of the edge on each side; the same from both ends.
        ahead: whether the side runs from the vertex with the smaller number.
        count: number of sides with each edge.
    """

    number: Int[np.ndarray, " S"]
    ahead: Bool[np.ndarray, " S"]
    count: Int[np.ndarray, " E"]

    def shared_by(self, sides: int) -> Int[np.ndarray, "E N"]:
        """Return the sides at each edge that this number of faces share."""
        order = np.argsort(self.number, kind="stable")
        return order[self.count[self.number[order]] == sides].reshape(-1, sides)

    def neighbours(self) -> Int[np.ndarray, "L 2"]:
        """Return sides at the same edge, each with the next."""
        order = np.argsort(self.number, kind="stable")
        same = self.number[order[1:]] == self.number[order[:-1]]
        return np.column_stack([order[:-1], order[1:]])[same]


def edges_of(faces: Int[np.ndarray, "N 3"]) -> Edges:
    """Return the edges of triangles."""
    start, end = faces.reshape(-1), np.roll(faces, -1, axis=1).reshape(-1)
    key = np.minimum(start, end).astype(np.int64) * (int(faces.max()) + 1) + np.maximum(start, end)
    _, number, count = np.unique(key, return_inverse=True, return_counts=True)
    return Edges(number, start < end, count)


def alike(
    edges: Edges, pairs: Int[np.ndarray, "L 2"], area: Float[np.ndarray, " N"]
) -> tuple[Int[np.ndarray, " N"], Bool[np.ndarray, " N"]]:
    """Return the body of each face, and which faces to turn for its faces to be wound alike.

    Each face has two nodes in a graph, itself and itself turned; neighbours' nodes are joined
    where they are wound alike. Of a body the smaller part is turned; a body that is joined to
    itself turned has one side alone, and stays as it is.

    Args:
        edges: edges of the faces.
        pairs: sides across which two faces go on.
        area: areas of the faces.
    """
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    count = len(area)
    one, two = pairs.T // 3
    against = edges.ahead[pairs[:, 0]] == edges.ahead[pairs[:, 1]]
    joined = np.where(against, count, 0)
    rows = np.concatenate([one, one + count])
    columns = np.concatenate([two + joined, two + count - joined])
    graph = coo_array((np.ones(len(rows), np.int8), (rows, columns)), shape=(2 * count, 2 * count))
    _, label = connected_components(graph, directed=False)
    itself, turned = label[:count], label[count:]
    _, body = np.unique(np.minimum(itself, turned), return_inverse=True)
    odd = itself > turned
    larger = np.bincount(body, np.where(odd, area, -area)) > 0.0
    return body, (odd ^ larger[body]) & (itself != turned)


def closed_bodies(
    body: Int[np.ndarray, " N"], flip: Bool[np.ndarray, " N"], edges: Edges
) -> Bool[np.ndarray, " B"]:
    """Return whose faces, some of them turned, pass each edge as often one way as the other."""
    passes = np.where(edges.ahead ^ np.repeat(flip, 3), 1, -1)
    many = len(edges.count)
    pair, at = np.unique(
        np.repeat(body, 3).astype(np.int64) * many + edges.number, return_inverse=True
    )
    closed = np.ones(body.max() + 1, bool)
    closed[pair[np.bincount(at, passes) != 0] // many] = False
    return closed


def is_closed(faces: Int[np.ndarray, "N 3"]) -> bool:
    """Tell whether faces pass each edge as often one way as the other: no edge is a rim."""
    if not len(faces):
        return False
    edges = edges_of(faces)
    return not np.bincount(edges.number, np.where(edges.ahead, 1, -1)).any()
