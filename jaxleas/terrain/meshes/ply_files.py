"""PLY files as triangles: text or binary, read from untrusted files."""

from collections.abc import Callable

import numpy as np
from jaxtyping import Float

from jaxleas.terrain.meshes.faces import MAX_POLYGON, triangulate
from jaxleas.terrain.meshes.ply_binary import rows_of_bytes
from jaxleas.terrain.meshes.ply_header import Broken, Columns, read_header
from jaxleas.terrain.meshes.ply_text import rows_of_text

_FACES = ("vertex_indices", "vertex_index")


def read_ply(
    content: bytes, broken: Broken, require_few: Callable[[int], None]
) -> tuple[Float[np.ndarray, "N 3 3"], bool]:
    """Return the triangles of a PLY file in the file's units, and whether they are 32-bit numbers.

    Args:
        content: bytes of the file.
        broken: makes the error of a reason why the file cannot be read.
        require_few: refuses a number of triangles that is too large.
    """
    layout, elements, body = read_header(content, broken)
    read = rows_of_text(body, broken) if layout == "ascii" else rows_of_bytes(body, layout, broken)
    found: dict[str, Columns] = {}
    for element in elements:
        found[element.name] = read(element)
        if "vertex" in found and "face" in found:
            break
    if "vertex" not in found or "face" not in found:
        raise broken("it has no faces: is it a cloud of points?")
    if not all(axis in found["vertex"] for axis in "xyz"):
        raise broken("its vertices lack x, y or z")
    points = np.stack([found["vertex"][axis] for axis in "xyz"], axis=-1).astype(np.float64)
    faces = next((found["face"][name] for name in _FACES if name in found["face"]), None)
    if not isinstance(faces, tuple):
        raise broken(f"its faces lack the list {_FACES[0]}")
    counts, corners = (np.asarray(each, np.int64) for each in faces)
    if ((corners < 0) | (corners >= len(points))).any():
        raise broken("a face has a corner that is no vertex")
    if (counts > MAX_POLYGON).any():
        raise broken(f"a face has {counts.max()} corners")
    enough = counts >= 3
    corners, counts = corners[np.repeat(enough, counts)], counts[enough]
    require_few(int((counts - 2).sum()))
    vertex = next(each for each in elements if each.name == "vertex")
    single = layout != "ascii" and all(
        kind == "f4" for name, kind, _ in vertex.properties if name in ("x", "y", "z")
    )
    return points[triangulate(points, corners, counts, broken)], single
