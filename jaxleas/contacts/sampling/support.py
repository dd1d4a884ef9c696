"""The prism along gravity above what carries: one sole, or the convex hull of several."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float

_POINT = 1e-9  # edges shorter than this are points [m]
_FLAT = 1e-12  # a point further right of an edge than this many square metres is outside
_LEAST_AREA = 1e-8  # hulls of a smaller area carry nothing [m^2]


@dataclass(frozen=True)
class Sides:
    """Half-spaces of each row: points c with normals . c <= slack.

    Attributes:
        normals: outward unit normals; zeros where a row has fewer half-spaces than others.
        slack: distances from the origin along them [m].
    """

    normals: Float[np.ndarray, "N R 3"]
    slack: Float[np.ndarray, "N R"]

    def __getitem__(self, rows) -> "Sides":
        """Return some of the rows."""
        return Sides(self.normals[rows], self.slack[rows])

    @classmethod
    def together(cls, *some: "Sides") -> "Sides":
        """Return the half-spaces of all together."""
        return cls(
            np.concatenate([each.normals for each in some], axis=1),
            np.concatenate([each.slack for each in some], axis=1),
        )


def sides_of_polygon(corners: Float[np.ndarray, "N C 3"], carries: Bool[np.ndarray, " N"]) -> Sides:
    """Return the prisms above polygons; where one is a point or carries nothing, an empty set.

    Args:
        corners: corners of each polygon, counter-clockwise seen from above [m].
        carries: whether each polygon carries.
    """
    edges = np.roll(corners, -1, axis=1) - corners
    normals = _outward(edges)
    slack = (normals * corners).sum(axis=2)
    slack[~carries | ~np.any(normals, axis=(1, 2))] = -1.0
    return Sides(normals, slack)


def sides_of_hull(points: Float[np.ndarray, "N K 3"], carries: Bool[np.ndarray, "N K"]) -> Sides:
    """Return the prism above the convex hull, seen from above, of those points that carry.

    From each vertex of the hull the edge goes to the farthest point that has no point to its right.
    Where the hull has no area, the half-spaces have no point in common.

    Args:
        points: points of contact [m].
        carries: whether each point belongs to the hull.
    """
    flat = points[..., :2]
    apart = flat[:, None] - flat[:, :, None]  # from i to j, [N, i, j, 2]
    x, y = apart[..., 0], apart[..., 1]
    turn = x[..., None] * y[:, :, None] - y[..., None] * x[:, :, None]  # of k about i -> j
    inside = np.all((turn >= -_FLAT) | ~carries[:, None, None], axis=3)
    length = np.hypot(x, y)
    edge = inside & carries[:, :, None] & carries[:, None] & (length > _POINT)
    farthest = np.where(edge, length, -1.0).argmax(axis=2)
    edges = np.take_along_axis(points, farthest[:, :, None], axis=1) - points
    edges = np.where(np.any(edge, axis=2)[:, :, None], edges, 0.0)
    normals = _outward(edges)
    exists = np.any(normals, axis=2)
    slack = np.where(exists, (normals * points).sum(axis=2), 1.0)
    # Width of the hull along each edge's normal: none has any if all points are in line.
    width = slack[:, :, None] - normals @ points.transpose(0, 2, 1)
    width = np.where(carries[:, None], width, 0.0).max(axis=2)
    area = np.where(exists, width * np.linalg.norm(edges[..., :2], axis=2), 0.0).max(axis=1)
    slack[area < _LEAST_AREA] = -1.0
    return Sides(normals, slack)


def _outward(edges: np.ndarray) -> np.ndarray:
    """Return horizontal unit normals to the right of edges; zeros for edges that are points."""
    outward = np.stack([edges[..., 1], -edges[..., 0], np.zeros(edges.shape[:-1])], axis=-1)
    length = np.linalg.norm(outward, axis=-1, keepdims=True)
    return np.where(length > _POINT, outward / np.maximum(length, _POINT), 0.0)
