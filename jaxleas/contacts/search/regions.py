"""Convex regions of a plane, and the part of each that a step's displacements reach.

A region is stated by its corners in space and, for clipping, in two coordinates of its plane.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from jaxtyping import Float

from jaxleas.contacts.search.bodies import Body
from jaxleas.contacts.search.corners import (
    clip,
    cross,
    distance_beyond,
    distinct,
    signed_area,
)
from jaxleas.contacts.surfaces import ContactSurface

SAME = 1e-10
"""A region counts as inside another one if no corner is outside by more than this [m]."""
AT_ONCE = 5
"""Number of half-spaces that clip a region before the others are looked at again."""


@dataclass(frozen=True, eq=False)
class Plane:
    """A plane with two axes in it: x = origin + local @ axes.

    Attributes:
        origin: a point of the plane [m].
        axes: two orthogonal unit vectors in the plane.
        normal: unit normal.
    """

    origin: Float[np.ndarray, " 3"]
    axes: Float[np.ndarray, "2 3"]
    normal: Float[np.ndarray, " 3"]

    @classmethod
    def of(cls, surface: ContactSurface) -> "Plane":
        """Return the plane of a surface."""
        corners = surface.vertices
        along = corners[1] - corners[0]
        along = along / np.sqrt(along @ along)
        return cls(corners[0], np.stack([along, cross(surface.normal, along)]), surface.normal)

    @classmethod
    def level(cls, point: Float[np.ndarray, " 3"]) -> "Plane":
        """Return the horizontal plane through a point."""
        return cls(point, np.eye(3)[:2], np.eye(3)[2])


@dataclass(frozen=True, eq=False)
class Region:
    """A convex polygon, a segment or a point.

    Attributes:
        plane: the plane in which it lies.
        corners: corners in the plane's coordinates, in order [m].
    """

    plane: Plane
    corners: Float[np.ndarray, "n 2"]

    @classmethod
    def of(cls, surface: ContactSurface) -> "Region":
        """Return the whole of a surface."""
        plane = Plane.of(surface)
        return cls(plane, (surface.vertices - plane.origin) @ plane.axes.T)

    @cached_property
    def vertices(self) -> Float[np.ndarray, "n 3"]:
        """The corners in the world [m]."""
        return self.plane.origin + self.corners @ self.plane.axes

    @cached_property
    def edges(self) -> tuple[Float[np.ndarray, "n 2"], Float[np.ndarray, " n"]]:
        """Outward unit normals of the edges in the plane's coordinates, and bounds [m]."""
        ends = np.roll(self.corners, -1, axis=0)
        along = ends - self.corners
        sign = 1.0 if signed_area(self.corners) >= 0.0 else -1.0
        outward = sign * np.stack([along[:, 1], -along[:, 0]], axis=1)
        outward /= np.sqrt(np.einsum("nk,nk->n", along, along))[:, None]
        return outward, np.einsum("nk,nk->n", outward, self.corners)

    def contains(self, other: "Region") -> bool:
        """Return whether another region of the same plane lies inside."""
        return self.outside(other) <= SAME

    def outside(self, other: "Region") -> float:
        """Return how far another region of the same plane sticks out [m]; negative: it does not."""
        if len(self.corners) < 3:
            return distance_beyond(self.corners, other.corners)
        outward, bounds = self.edges
        return float((other.corners @ outward.T - bounds).max())

    def clipped(
        self, normals: Float[np.ndarray, "m 3"], bounds: Float[np.ndarray, " m"]
    ) -> "Region | None":
        """Return the part inside half-spaces of the world; None if it is empty.

        Args:
            normals: unit normals of the half-spaces.
            bounds: bounds along the normals [m].
        """
        plane = self.plane
        rows = normals @ plane.axes.T
        limits = bounds - normals @ plane.origin
        excess = (self.corners @ rows.T - limits).max(axis=0)
        cutting = np.flatnonzero(excess > 0.0)
        if not len(cutting):
            return self
        corners = self.corners
        while len(cutting):  # the deepest cuts first: most of the others then cut nothing
            deepest = cutting[np.argsort(-excess[cutting])[:AT_ONCE]]
            left = [(x, y) for x, y in corners.tolist()]
            for (a, b), c in zip(rows[deepest].tolist(), limits[deepest].tolist(), strict=True):
                left = clip(left, a, b, c)
                if not left:
                    return None
            excess[deepest] = 0.0
            corners = np.array(distinct(left))
            excess[cutting] = np.minimum(
                excess[cutting], (corners @ rows[cutting].T - limits[cutting]).max(axis=0)
            )
            cutting = cutting[excess[cutting] > 0.0]
        return Region(plane, corners)


def sum_rows(region: Region, body: Body) -> tuple[np.ndarray, np.ndarray]:
    """Return half-spaces whose intersection is the sum of a region and a body.

    Faces of the sum are those of the body, the region's plane on either side, and one for each pair
    of edges that face the same way. Bounds are what region and body reach together, so that an
    imprecise normal makes the sum larger, never smaller.
    """
    corners = region.vertices
    normals = [body.normals]
    if len(corners) > 1:
        normal = region.plane.normal
        along = np.roll(corners, -1, axis=0) - corners
        outward = cross(along, normal)
        if signed_area(region.corners) < 0.0:
            outward = -outward
        first, second = body.between[:, 0], body.between[:, 1]
        slope, other = first @ along.T, second @ along.T  # [E, n]
        edge, side = np.nonzero(slope * other < 0.0)
        weight = np.abs(other[edge, side])[:, None], np.abs(slope[edge, side])[:, None]
        mixed = weight[0] * first[edge] + weight[1] * second[edge]
        if len(corners) > 2:
            mixed = mixed[np.einsum("nk,nk->n", mixed, outward[side]) >= 0.0]
        length = np.sqrt(np.einsum("nk,nk->n", mixed, mixed))[:, None]
        normals += [normal[None], -normal[None], mixed / np.maximum(length, 1e-300)]
    every = np.concatenate(normals)
    reach = (every @ corners.T).max(axis=1)
    own = len(body.normals)
    return every, reach + np.concatenate([body.offsets, body.support(every[own:])])
