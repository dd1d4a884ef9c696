"""Contact surfaces: exactly planar convex polygons, and their half-spaces (T eq. 5.1)."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from jaxtyping import Float
from scipy.spatial import ConvexHull

from jaxleas.terrain import MIN_AREA, polygon_area_vector, require_few, require_planar_and_convex
from jaxleas.types import InputError

_STRICTLY_CONVEX = 1e-9  # a corner that turns by less than this is not a corner [m]


@dataclass(frozen=True, eq=False)
class ContactSurface:
    """One convex polygon in a plane: p is on it iff d . p = e and S p <= s (T eq. 5.1).

    Attributes:
        vertices: vertices in a plane, convex, counter-clockwise seen from above [m].
    """

    vertices: Float[np.ndarray, "V 3"]

    @cached_property
    def normal(self) -> Float[np.ndarray, " 3"]:
        """The unit normal d; it points upwards unless the surface is a wall."""
        area = polygon_area_vector(self.vertices)
        return area / np.linalg.norm(area)

    @cached_property
    def offset(self) -> float:
        """The plane's offset e [m]."""
        return float(self.vertices.mean(axis=0) @ self.normal)

    @cached_property
    def edge_normals(self) -> Float[np.ndarray, "V 3"]:
        """The rows of S: unit vectors in the plane, outwards through each edge."""
        edges = np.roll(self.vertices, -1, axis=0) - self.vertices
        outward = np.cross(edges, self.normal)
        return outward / np.linalg.norm(outward, axis=1, keepdims=True)

    @cached_property
    def edge_offsets(self) -> Float[np.ndarray, " V"]:
        """The vector s [m]."""
        return np.einsum("vk,vk->v", self.edge_normals, self.vertices)

    @cached_property
    def basis(self) -> Float[np.ndarray, "2 3"]:
        """Two orthogonal unit vectors in the plane."""
        first = self.edge_normals[0]
        return np.stack([first, np.cross(self.normal, first)])

    def distance(self, points: Float[np.ndarray, "*batch 3"]) -> Float[np.ndarray, "*batch"]:
        """Return the worst violation of the plane or an edge by points [m]; 0 on the surface."""
        plane = np.abs(points @ self.normal - self.offset)
        edges = np.max(points @ self.edge_normals.T - self.edge_offsets, axis=-1)
        return np.maximum(plane, np.maximum(edges, 0.0))


def make_surface(vertices: Float[np.ndarray, "V 3"], where: str) -> ContactSurface:
    """Return the surface of a polygon that is planar and convex to a millimetre, made exactly so.

    Vertices are moved onto the mean plane, and those that are no corners dropped. Clockwise lists
    are reversed: the normal of a surface that is not a wall points upwards.

    Args:
        vertices: corners in order [m].
        where: name of the file and the surface, for messages.

    Raises:
        InputError: it is not a planar convex polygon; says by how many metres.
    """
    require_polygon(vertices, where)
    area = polygon_area_vector(vertices)
    normal = area / np.linalg.norm(area)
    if normal[2] < -1e-3:  # steeper than this is a wall, whose winding says which side is outside
        vertices, normal = vertices[::-1], -normal
    centre = vertices.mean(axis=0)
    flat = vertices - np.outer((vertices - centre) @ normal, normal)
    return ContactSurface(flat[_corners(flat, normal)])


def require_polygon(vertices: Float[np.ndarray, "V 3"], where: str) -> None:
    """Refuse a polygon that is not planar and convex; unlike on a terrain, it may be clockwise."""
    if len(vertices) < 3:
        raise InputError(f"{where} has {len(vertices)} vertices; a polygon needs at least 3")
    require_few(vertices, where)
    if not np.isfinite(vertices).all():
        raise InputError(f"{where} has a coordinate that is not a finite number")
    if np.linalg.norm(polygon_area_vector(vertices)) < MIN_AREA:
        raise InputError(f"{where} is degenerate: its area is below {MIN_AREA:g} m^2")
    apart = np.linalg.norm(vertices[:, None] - vertices, axis=-1)
    if (apart[np.triu_indices(len(vertices), 1)] < 1e-6).any():
        raise InputError(f"{where} repeats a vertex; list each corner once")
    require_planar_and_convex(vertices, where)


def _corners(flat: np.ndarray, normal: np.ndarray) -> np.ndarray:
    """Return the indices of the convex hull's corners, in the order given."""
    edges = np.roll(flat, -1, axis=0) - flat
    before = np.roll(edges, 1, axis=0)
    before /= np.linalg.norm(before, axis=1, keepdims=True)
    if (np.cross(before, edges) @ normal > _STRICTLY_CONVEX).all():
        return np.arange(len(flat))
    across = np.cross(normal, edges[0]) / np.linalg.norm(edges[0])
    along = np.cross(across, normal)
    return np.sort(ConvexHull(np.stack([flat @ along, flat @ across], axis=1)).vertices)
