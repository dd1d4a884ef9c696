"""Convex bodies as this search needs them: corners, faces, and the two faces at every edge.

The sum of two bodies has the faces of either, and one for each pair of edges whose arcs cross on
the sphere of directions: the arc of an edge joins the normals of the two faces that meet in it. A
face of a sum is stated by its direction alone; how far the sum reaches in it is the sum of how far
the bodies reach, so that no rounding of directions makes a sum too small.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from jaxtyping import Float
from scipy import sparse
from scipy.spatial import ConvexHull, HalfspaceIntersection, QhullError

from jaxleas.contacts.programs.linear_program import Program, solve

_SAME_FACE = 1e-12  # 1 - cosine between faces of which no edge is between
_FLAT = 1e-9  # a body in which no ball of this radius fits is treated as empty [m]
_MOST_RADIUS = 1e3  # [m]


@dataclass(frozen=True, eq=False)
class Body:
    """A convex polytope with an inside.

    Attributes:
        vertices: its corners [m].
        normals: outward unit normal of each face.
        between: normals of the two faces that meet in each edge.
    """

    vertices: Float[np.ndarray, "V 3"]
    normals: Float[np.ndarray, "F 3"]
    between: Float[np.ndarray, "E 2 3"]

    @cached_property
    def offsets(self) -> Float[np.ndarray, " F"]:
        """Distance of each face from the origin along its normal [m]."""
        return self.support(self.normals)

    @cached_property
    def low(self) -> Float[np.ndarray, " 3"]:
        """Least coordinates [m]."""
        return self.vertices.min(axis=0)

    @cached_property
    def high(self) -> Float[np.ndarray, " 3"]:
        """Greatest coordinates [m]."""
        return self.vertices.max(axis=0)

    def support(self, directions: Float[np.ndarray, "n 3"]) -> Float[np.ndarray, " n"]:
        """Return how far the body reaches in each direction [m]."""
        return (directions @ self.vertices.T).max(axis=1)

    def turned(self, yaw: float) -> "Body":
        """Return the body turned about the vertical [rad]."""
        cosine, sine = np.cos(yaw), np.sin(yaw)
        back = np.array([[cosine, sine, 0.0], [-sine, cosine, 0.0], [0.0, 0.0, 1.0]])
        return Body(self.vertices @ back, self.normals @ back, self.between @ back)

    def reversed(self) -> "Body":
        """Return the body of the opposite points."""
        return Body(-self.vertices, -self.normals, -self.between)


def body_of(normals: Float[np.ndarray, "n 3"], offsets: Float[np.ndarray, " n"]) -> Body | None:
    """Return the body {x : normals x <= offsets}; None if no ball fits into it.

    Args:
        normals: outward unit normals; some may bound nothing.
        offsets: bounds along the normals [m].
    """
    centre = _middle(normals, offsets)
    if centre is None:
        return None
    halfspaces = np.concatenate([normals, -offsets[:, None]], axis=1)
    try:
        return hull_of(HalfspaceIntersection(halfspaces, centre).intersections)
    except QhullError:
        return None


def hull_of(corners: Float[np.ndarray, "n 3"]) -> Body:
    """Return the convex hull of points that span a volume [m]."""
    hull = ConvexHull(corners)
    faces = hull.equations[:, :3]
    first = np.repeat(np.arange(len(faces)), 3)
    second = hull.neighbors.reshape(-1)
    pairs = np.stack([faces[first], faces[second]], axis=1)
    kept = (first < second) & (np.einsum("ek,ek->e", pairs[:, 0], pairs[:, 1]) < 1.0 - _SAME_FACE)
    _, distinct = np.unique(np.round(faces, 9), axis=0, return_index=True)
    return Body(corners[hull.vertices], faces[distinct], pairs[kept])


def faces_of_sum(one: Body, other: Body) -> Float[np.ndarray, "n 3"]:
    """Return the directions of all faces of the sum of two bodies, and perhaps some more."""
    along, across = _along(one.between), _along(other.between)
    here = one.between @ across.T  # [E, 2, E']
    there = other.between @ along.T  # [E', 2, E]
    crossing = (here[:, 0] * here[:, 1] < 0.0) & (there[:, 0] * there[:, 1] < 0.0).T
    first, second = np.nonzero(crossing)
    normals = np.cross(along[first], across[second])
    outward = one.between[first].sum(axis=1)
    side = np.einsum("nk,nk->n", normals, outward)
    normals *= np.sign(side)[:, None]
    same = np.einsum("nk,nk->n", normals, other.between[second].sum(axis=1)) > 0.0
    normals = normals[same]
    length = np.linalg.norm(normals, axis=1)
    normals = normals[length > 1e-12] / length[length > 1e-12, None]
    return np.concatenate([one.normals, other.normals, normals])


def _along(between: np.ndarray) -> np.ndarray:
    """Return the unit direction of each edge."""
    along = np.cross(between[:, 0], between[:, 1])
    return along / np.linalg.norm(along, axis=1, keepdims=True)


def _middle(normals: np.ndarray, offsets: np.ndarray) -> np.ndarray | None:
    """Return the centre of the largest ball inside; None if there is none."""
    count = len(offsets)
    program = Program(
        cost=np.array([0.0, 0.0, 0.0, -1.0]),
        low=np.array([-np.inf, -np.inf, -np.inf, -_MOST_RADIUS]),
        high=np.array([np.inf, np.inf, np.inf, _MOST_RADIUS]),
        A=sparse.csr_array(np.concatenate([normals, np.ones((count, 1))], axis=1)),
        row_low=np.full(count, -np.inf),
        row_high=offsets,
    )
    solution = solve(program)
    if solution.status != "optimal" or solution.x[3] < _FLAT:
        return None
    return solution.x[:3]
