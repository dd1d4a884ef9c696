"""Bodies of a mesh: closed ones are wound outwards, whatever the file says of inside and outside.

Faces that share an edge belong together; they are wound alike if they pass the edge in opposite
directions. A body is closed if its faces pass each edge as often one way as the other. Where bodies
touch face to face, more than two faces share an edge: see `_touching`.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Int

COINCIDENT = 1e-6
"""Faces at an edge lie on each other if 1 - cosine of the angle between them is below this."""
_DIRECTION = np.array([0.3141, 0.5772, 0.7543])  # of rays; along no edge that people draw
_MOST_NESTED = 200  # bodies inside out for which it is asked what contains them


WELD = 1e-5
"""Distance below which vertices are merged [m]."""


def welded(
    triangles: Float[np.ndarray, "T 3 3"],
) -> tuple[Float[np.ndarray, "P 3"], Int[np.ndarray, "N 3"]]:
    """Return the vertices of triangles, each once, and the triangles that keep three of them."""
    corners = triangles.reshape(-1, 3)
    _, first, index = np.unique(
        np.round(corners / WELD).astype(np.int64), axis=0, return_index=True, return_inverse=True
    )
    faces = index.reshape(-1, 3)
    return corners[first], faces[(faces != np.roll(faces, 1, axis=1)).all(axis=1)]


@dataclass(frozen=True)
class Oriented:
    """Faces wound outwards.

    Attributes:
        faces: corners of each triangle, counter-clockwise seen from outside its body.
        turned: number of faces that were wound the other way.
        bodies: number of bodies to which those belong.
    """

    faces: Int[np.ndarray, "N 3"]
    turned: int
    bodies: int


def orient(points: Float[np.ndarray, "P 3"], faces: Int[np.ndarray, "N 3"]) -> Oriented:
    """Wind the faces of each body alike, and those of closed bodies outwards.

    An open sheet keeps the winding of the larger part of its area. A closed body inside out stays
    as it is inside another one, of which it is a cavity, and around others, as a room.

    Args:
        points: vertices [m].
        faces: corners of each triangle; no triangle repeats a vertex.
    """
    if not len(faces):
        return Oriented(faces, 0, 0)
    corners = points[faces]
    area = 0.5 * np.linalg.norm(
        np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1
    )
    edges = _edges(faces)
    body, flip = _alike(edges, edges.shared_by(2), area)
    closed = _closed(body, flip, edges)
    if not closed.all():
        body, flip = _touching(points, faces, edges, area, (body, flip, closed[body]))
        closed = _closed(body, flip, edges)
    centred = corners - points.mean(axis=0)
    volume = np.einsum("fk,fk->f", centred[:, 0], np.cross(centred[:, 1], centred[:, 2])) / 6.0
    inside_out = closed & (np.bincount(body, np.where(flip, -volume, volume)) < 0.0)
    inside_out &= ~_nested(corners, body, closed, inside_out)
    flip ^= inside_out[body]
    return Oriented(
        np.where(flip[:, None], faces[:, ::-1], faces), int(flip.sum()), len(np.unique(body[flip]))
    )


def is_closed(faces: Int[np.ndarray, "N 3"]) -> bool:
    """Tell whether faces pass each edge as often one way as the other: no edge is a rim."""
    if not len(faces):
        return False
    edges = _edges(faces)
    return not np.bincount(edges.number, np.where(edges.ahead, 1, -1)).any()


@dataclass(frozen=True)
class _Edges:
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


def _edges(faces: Int[np.ndarray, "N 3"]) -> _Edges:
    start, end = faces.reshape(-1), np.roll(faces, -1, axis=1).reshape(-1)
    key = np.minimum(start, end).astype(np.int64) * (int(faces.max()) + 1) + np.maximum(start, end)
    _, number, count = np.unique(key, return_inverse=True, return_counts=True)
    return _Edges(number, start < end, count)


def _touching(
    points: np.ndarray,
    faces: np.ndarray,
    edges: _Edges,
    area: np.ndarray,
    found: tuple[np.ndarray, np.ndarray, np.ndarray],
) -> tuple[Int[np.ndarray, " N"], Bool[np.ndarray, " N"]]:
    """Return bodies and what to turn, looking again at what is not closed across pairs of faces.

    All faces that hang together at edges make one body if they close it as the file winds them.
    Otherwise, where two of four faces at an edge lie on each other, these are inside and the two
    others go on across the edge, if that closes the body.
    """
    body, flip, settled = found
    hanging, _ = _alike(edges, edges.neighbours(), area)
    as_given = _closed(hanging, np.zeros(len(faces), bool), edges)[hanging] & ~settled
    fours = edges.shared_by(4)
    pairs = np.concatenate([edges.shared_by(2), _outer(points, faces, fours)])
    across, turned = _alike(edges, pairs, area)
    mended = _closed(across, turned, edges)[across] & ~settled & ~as_given
    label = np.select([as_given, mended], [hanging + len(faces), across + 2 * len(faces)], body)
    return (
        np.unique(label, return_inverse=True)[1],
        np.select([as_given, mended], [np.zeros_like(flip), turned], flip),
    )


def _outer(
    points: np.ndarray, faces: np.ndarray, sides: Int[np.ndarray, "E 4"]
) -> Int[np.ndarray, "S 2"]:
    """Return, where two of four faces at an edge lie on each other, the two others."""
    start, end, third = (np.roll(faces, -k, axis=1).reshape(-1)[sides] for k in range(3))
    along = points[end[:, :1]] - points[start[:, :1]]
    along /= np.linalg.norm(along, axis=-1, keepdims=True)
    away = points[third] - points[start]
    away -= np.einsum("esk,esk->es", away, np.broadcast_to(along, away.shape))[..., None] * along
    away /= np.maximum(np.linalg.norm(away, axis=-1, keepdims=True), 1e-12)
    ways = [((0, 1), (2, 3)), ((0, 2), (1, 3)), ((0, 3), (1, 2))]
    ways += [(others, both) for both, others in ways]
    on = np.array([np.einsum("ek,ek->e", away[:, a], away[:, b]) for (a, b), _ in ways])
    on = on.reshape(len(ways), -1) > 1.0 - COINCIDENT
    single = on.sum(axis=0) == 1
    others = np.array([each for _, each in ways])[np.argmax(on, axis=0)]
    return np.take_along_axis(sides, others, axis=1)[single]


def _alike(
    edges: _Edges, pairs: Int[np.ndarray, "L 2"], area: Float[np.ndarray, " N"]
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


def _closed(
    body: Int[np.ndarray, " N"], flip: Bool[np.ndarray, " N"], edges: _Edges
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


def _nested(
    corners: Float[np.ndarray, "N 3 3"],
    body: Int[np.ndarray, " N"],
    closed: Bool[np.ndarray, " B"],
    asked: Bool[np.ndarray, " B"],
) -> Bool[np.ndarray, " B"]:
    """Return which of the bodies asked for lie inside a closed one, or around one."""
    nested = np.zeros(len(closed), bool)
    number = np.flatnonzero(asked)
    if not len(number) or len(number) > _MOST_NESTED or closed.sum() < 2:
        return nested
    low, high = (np.full((len(closed), 3), value) for value in (np.inf, -np.inf))
    np.minimum.at(low, body, corners.min(axis=1))
    np.maximum.at(high, body, corners.max(axis=1))
    for each in number:
        around = closed & (low < low[each]).all(axis=1) & (high > high[each]).all(axis=1)
        within = closed & (low > low[each]).all(axis=1) & (high < high[each]).all(axis=1)
        own = corners[body == each]
        nested[each] = any(_is_inside(own[0, 0], corners[body == b]) for b in _some(around)) or any(
            _is_inside(corners[body == b][0, 0], own) for b in _some(within)
        )
    return nested


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
