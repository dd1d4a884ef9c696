"""Polygonal faces of meshes cut into triangles; concave ones by the ear clipping of Mapbox."""

from collections.abc import Callable

import numpy as np
from jaxtyping import Float, Int

from jaxleas.types import InputError

MAX_POLYGON = 1000
"""Largest number of corners of one face."""
_AREA_TOLERANCE = 1e-6  # relative; of a polygon that does not cross itself the triangles add up


def triangulate(
    points: Float[np.ndarray, "P 3"],
    corners: Int[np.ndarray, " C"],
    counts: Int[np.ndarray, " F"],
    broken: Callable[[str], InputError],
) -> Int[np.ndarray, "N 3"]:
    """Return the triangles of faces with any number of corners, wound as the faces are.

    Args:
        points: vertices [m].
        corners: indices of the vertices of all faces, one face after another.
        counts: number of corners of each face, at least 3.
        broken: makes the error of a reason why the faces cannot be used.

    Raises:
        InputError: a face crosses itself.
    """
    first = np.cumsum(counts) - counts
    parts, order = [], []
    for count in np.unique(counts):
        members = np.flatnonzero(counts == count)
        faces = corners[first[members, None] + np.arange(count)]
        if count == 3:
            parts.append(faces)
            order.append(members)
            continue
        convex = _is_convex(points[faces])
        fans = np.stack(
            [np.repeat(faces[convex, :1], count - 2, axis=1), faces[convex, 1:-1],
             faces[convex, 2:]], axis=-1
        )  # fmt: skip
        parts.append(fans.reshape(-1, 3))
        order.append(np.repeat(members[convex], count - 2))
        for member, face in zip(members[~convex], faces[~convex], strict=True):
            cut = _clip_ears(points, face, broken)
            parts.append(cut)
            order.append(np.full(len(cut), member))
    if not parts:
        return np.zeros((0, 3), np.int64)
    return np.concatenate(parts)[np.argsort(np.concatenate(order), kind="stable")]


def _newell(vertices: Float[np.ndarray, "*F V 3"]) -> Float[np.ndarray, "*F 3"]:
    """Return the area vectors of polygons: along the right-hand normal, as long as the area."""
    centred = vertices - vertices.mean(axis=-2, keepdims=True)
    return 0.5 * np.cross(centred, np.roll(centred, -1, axis=-2)).sum(axis=-2)


def _is_convex(vertices: Float[np.ndarray, "F V 3"]) -> np.ndarray:
    """Return which polygons never bend to the outside and go round once."""
    normal = _newell(vertices)
    length = np.linalg.norm(normal, axis=-1, keepdims=True)
    normal = np.divide(normal, length, out=np.zeros_like(normal), where=length > 0.0)
    edge = np.roll(vertices, -1, axis=1) - vertices
    before = np.roll(edge, 1, axis=1)
    bend = np.einsum("fvk,fk->fv", np.cross(before, edge), normal)
    size = np.linalg.norm(before, axis=-1) * np.linalg.norm(edge, axis=-1)
    turned = np.arctan2(bend, np.einsum("fvk,fvk->fv", before, edge)).sum(axis=1)
    return (bend >= -1e-9 * size).all(axis=1) & (turned < 3.0 * np.pi)


def _clip_ears(
    points: np.ndarray, face: Int[np.ndarray, " V"], broken: Callable[[str], InputError]
) -> Int[np.ndarray, "N 3"]:
    import mapbox_earcut

    vertices = points[face]
    area = _newell(vertices)
    fan = np.cross(vertices[1:-1] - vertices[0], vertices[2:] - vertices[0])
    most = 0.5 * np.linalg.norm(fan, axis=1).sum()
    if not most > 0.0:
        return np.zeros((0, 3), np.int64)  # all on a line
    if not np.linalg.norm(area) > _AREA_TOLERANCE * most:
        raise broken(_crossing(face))
    across = int(np.argmax(np.abs(area)))  # looked at along this axis
    flat = np.delete(vertices - vertices.mean(axis=0), across, axis=1)
    ends = np.array([len(flat)], np.uint32)
    found = mapbox_earcut.triangulate_float64(np.ascontiguousarray(flat), ends)
    triangles = face[np.asarray(found, np.int64).reshape(-1, 3)]
    areas = _newell(points[triangles]) @ area / float(area @ area)
    if abs(np.abs(areas).sum() - 1.0) > _AREA_TOLERANCE:
        raise broken(_crossing(face))
    return np.where(areas[:, None] < 0.0, triangles[:, ::-1], triangles)


def _crossing(face: Int[np.ndarray, " V"]) -> str:
    numbers = " ".join(str(each + 1) for each in face[:6])
    return f"the face of {len(face)} corners that begins with {numbers} crosses itself"
