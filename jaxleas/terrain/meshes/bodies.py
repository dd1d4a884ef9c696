"""Bodies of a mesh, wound outwards, whatever the file says of inside and outside."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int

from jaxleas.terrain.meshes.mesh_edges import alike, closed_bodies, edges_of
from jaxleas.terrain.meshes.nesting import nested
from jaxleas.terrain.meshes.touching import rejoined


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
    edges = edges_of(faces)
    body, flip = alike(edges, edges.shared_by(2), area)
    closed = closed_bodies(body, flip, edges)
    if not closed.all():
        body, flip = rejoined(points, faces, edges, area, (body, flip, closed[body]))
        closed = closed_bodies(body, flip, edges)
    centred = corners - points.mean(axis=0)
    volume = np.einsum("fk,fk->f", centred[:, 0], np.cross(centred[:, 1], centred[:, 2])) / 6.0
    inside_out = closed & (np.bincount(body, np.where(flip, -volume, volume)) < 0.0)
    inside_out &= ~nested(corners, body, closed, inside_out)
    flip ^= inside_out[body]
    return Oriented(
        np.where(flip[:, None], faces[:, ::-1], faces), int(flip.sum()), len(np.unique(body[flip]))
    )
