"""Half-edges: the sides of faces that share a plane, joined and simplified many at a time.

Half-edge h runs from `origin[h]` along the border of its face, the face to its left, to the origin
of `following[h]`; `twin[h]` runs the other way along the face behind it, or is -1.
"""

import numpy as np
from jaxtyping import Bool, Float, Int

from jaxleas.terrain.areas import lengths

Sides = Int[np.ndarray, " H"]


def facing_sides(triangles: Int[np.ndarray, "T 3"]) -> Int[np.ndarray, "E 2"]:
    """Return sides of triangles that run along one edge, in opposite directions.

    Side 3 t + k begins at corner k of triangle t. Of several sides of one direction the first
    counts.
    """
    start, end = triangles.reshape(-1), np.roll(triangles, -1, axis=1).reshape(-1)
    many = int(triangles.max(initial=0)) + 1
    edge = np.minimum(start, end).astype(np.int64) * many + np.maximum(start, end)
    order = np.argsort(2 * edge + (start > end), kind="stable")  # by edge, then direction
    edge, ahead = edge[order], (start < end)[order]
    first = np.ones(len(order), bool)
    first[1:] = (edge[1:] != edge[:-1]) | (ahead[1:] != ahead[:-1])
    order, edge = order[first], edge[first]
    both = np.flatnonzero(edge[1:] == edge[:-1])
    return np.stack([order[both], order[both + 1]], axis=1).astype(np.int32)


class HalfEdges:
    """Borders of triangles, from which needless edges and vertices are taken.

    Attributes:
        origin: vertex at which each half-edge begins.
        following: next half-edge around the face.
        before: previous half-edge around the face.
        twin: half-edge on the other side; -1 for none.
        alive: whether the half-edge is part of a border still.
    """

    def __init__(self, triangles: Int[np.ndarray, "T 3"], pairs: Int[np.ndarray, "E 2"]) -> None:
        """Make the borders of triangles.

        Args:
            triangles: corners of each triangle; half-edge 3 t + k begins at corner k of t.
            pairs: half-edges that are each other's twins.
        """
        self.origin = triangles.reshape(-1).astype(np.int32)
        side = np.arange(len(self.origin), dtype=np.int32)
        self.following = np.where(side % 3 == 2, side - 2, side + 1)
        self.before = np.where(side % 3 == 0, side + 2, side - 1)
        self.twin = np.full(len(side), -1, np.int32)
        self.twin[pairs[:, 0]], self.twin[pairs[:, 1]] = pairs[:, 1], pairs[:, 0]
        self.alive = np.ones(len(side), bool)
        self._draw = np.random.default_rng(0)  # which of several neighbours comes first
        self._claim = np.full(len(side), -1, np.int32)

    @property
    def end(self) -> Sides:
        """Vertices at which all half-edges end."""
        return self.origin[self.following]

    def join(self, sides: Sides) -> Sides:
        """Take edges away, each of two faces that have no other part in it.

        Returns:
            Half-edges at whose ends edges ended that are gone.
        """
        twin = self.twin[sides]
        ends = self.before[sides], self.following[sides], self.before[twin], self.following[twin]
        self._link(ends[0], ends[3])
        self._link(ends[2], ends[1])
        self.alive[sides] = self.alive[twin] = False
        return np.concatenate([ends[0], ends[2]])

    def straighten(self, points: Float[np.ndarray, "P 3"], sides: Sides, slack: float) -> Sides:
        """Take away vertices on straight lines which no third face shares.

        Args:
            points: vertices [m].
            sides: half-edges that end at the vertices asked about.
            slack: largest distance of a vertex from the line between its neighbours [m].

        Returns:
            Half-edges that are longer than before.
        """
        longer: list[np.ndarray] = []
        while True:
            sides = sides[self.alive[sides]]
            ahead = self.following[sides]
            back = self.twin[sides], self.twin[ahead]
            inner = (back[0] >= 0) & (back[1] >= 0) & (self.following[back[1]] == back[0])
            sides = sides[inner]
            # of the two half-edges that end at a vertex, either is enough
            sides = once(np.minimum(sides, self.twin[self.following[sides]]))
            sides = sides[self._are_straight(points, sides, slack)]
            if not len(sides):
                return np.concatenate(longer) if longer else sides
            chosen = sides[self._apart(sides)]
            twin, twin_ahead = self.twin[chosen], self.twin[self.following[chosen]]
            self._cut(chosen)
            self.origin[twin] = self.origin[twin_ahead]
            self._link(self.before[twin_ahead], twin)
            self.alive[twin_ahead] = False
            longer.append(chosen)

    def simplify(self, points: Float[np.ndarray, "P 3"], slack: float) -> None:
        """Take away vertices on straight lines from each face by itself; there are no twins then.

        Args:
            points: vertices [m].
            slack: largest distance of a vertex from the line between its neighbours [m].
        """
        self.twin[:] = -1
        sides = np.flatnonzero(self.alive)
        while True:
            sides = sides[self.alive[sides]]
            sides = sides[self._are_straight(points, sides, slack)]
            if not len(sides):
                return
            self._cut(sides[self._apart(sides)])

    def loops(self, first: Sides) -> tuple[Int[np.ndarray, " C"], Int[np.ndarray, " F"]]:
        """Return the vertices around faces, one face after another, and the number of each.

        Args:
            first: a half-edge of each face.
        """
        face, here = np.arange(len(first)), first
        faces, vertices = [], []
        while len(face):
            faces.append(face)
            vertices.append(self.origin[here])
            here = self.following[here]
            on = here != first[face]
            face, here = face[on], here[on]
        if not faces:
            return np.zeros(0, np.int32), np.zeros(0, np.int64)
        number = np.concatenate(faces)
        order = np.argsort(number, kind="stable")
        return np.concatenate(vertices)[order], np.bincount(number, minlength=len(first))

    def _link(self, one: Sides, other: Sides) -> None:
        self.following[one], self.before[other] = other, one

    def _cut(self, sides: Sides) -> None:
        """Let half-edges run on to the end of the next, which goes."""
        ahead = self.following[sides]
        self.alive[ahead] = False
        self._link(sides, self.following[ahead])

    def _are_straight(
        self, points: Float[np.ndarray, "P 3"], sides: Sides, slack: float
    ) -> Bool[np.ndarray, " H"]:
        """Return which half-edges go straight on into the next, in a face with corners to spare."""
        ahead = self.following[sides]
        last = self.following[ahead]
        start = points[self.origin[sides]]
        way, rest = points[self.origin[last]] - start, points[self.origin[ahead]] - start
        length = np.maximum(lengths(way), 1e-12)
        along = np.einsum("hk,hk->h", way, rest) / length
        off = np.einsum("hk,hk->h", rest, rest) - along**2
        spare = self.following[last] != sides
        twin = self.twin[sides]
        shared = twin >= 0
        other = self.following[self.following[twin]] != self.twin[ahead]
        within = (along > 0.0) & (along < length)
        return (off <= slack**2) & within & spare & (other | ~shared)

    def _apart(self, sides: Sides) -> Bool[np.ndarray, " H"]:
        """Return which half-edges to cut at once: none touches what another one changes."""
        ahead = self.following[sides]
        touched = [self.before[sides], sides, ahead, self.following[ahead]]
        twin, twin_ahead = self.twin[sides], self.twin[ahead]
        shared = (twin >= 0) & (twin_ahead >= 0)
        touched.append(np.where(shared, self.following[twin], sides))
        touched.append(np.where(shared, self.before[twin_ahead], sides))
        edges = [np.maximum(each, self.twin[each]) for each in touched]
        rank = self._draw.permutation(len(sides)).astype(np.int32)
        for each in edges:
            self._claim[each] = -1
        for each in edges:
            np.maximum.at(self._claim, each, rank)
        return np.all([self._claim[each] == rank for each in edges], axis=0)


def once(sides: Sides) -> Sides:
    """Return each half-edge once; faster than `np.unique`."""
    sides = np.sort(sides)
    return sides[np.diff(sides, prepend=-1) > 0]
