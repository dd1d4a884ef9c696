"""Bodies that touch face to face, where more than two faces share an edge."""

import numpy as np
from jaxtyping import Bool, Int

from jaxleas.terrain.meshes.mesh_edges import Edges, alike, closed_bodies

COINCIDENT = 1e-6
"""Faces at an edge lie on each other if 1 - cosine of the angle between them is below this."""


def rejoined(
    points: np.ndarray,
    faces: np.ndarray,
    edges: Edges,
    area: np.ndarray,
    found: tuple[np.ndarray, np.ndarray, np.ndarray],
) -> tuple[Int[np.ndarray, " N"], Bool[np.ndarray, " N"]]:
    """Return bodies and what to turn, looking again at what is not closed across pairs of faces.

    All faces that hang together at edges make one body if they close it as the file winds them.
    Otherwise, where two of four faces at an edge lie on each other, these are inside and the two
    others go on across the edge, if that closes the body.
    """
    body, flip, settled = found
    hanging, _ = alike(edges, edges.neighbours(), area)
    as_given = closed_bodies(hanging, np.zeros(len(faces), bool), edges)[hanging] & ~settled
    fours = edges.shared_by(4)
    pairs = np.concatenate([edges.shared_by(2), _outer(points, faces, fours)])
    across, turned = alike(edges, pairs, area)
    mended = closed_bodies(across, turned, edges)[across] & ~settled & ~as_given
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
