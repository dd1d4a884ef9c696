"""OFF files as triangles: vertices and faces as text, read from untrusted files."""

import re
from collections.abc import Callable

import numpy as np
from jaxtyping import Float

from jaxleas.terrain.meshes.faces import MAX_POLYGON, triangulate
from jaxleas.terrain.text_numbers import shown, vectors
from jaxleas.types import InputError


def read_off(
    content: bytes, broken: Callable[[str], InputError], require_few: Callable[[int], None]
) -> Float[np.ndarray, "N 3 3"]:
    """Return the triangles of an OFF file, in the file's units.

    Args:
        content: bytes of the file; colours and normals of vertices and faces are passed over.
        broken: makes the error of a reason why the file cannot be read.
        require_few: refuses a number of triangles that is too large.
    """
    lines = [line for raw in content.splitlines() if (line := raw.split(b"#", 1)[0].strip())]
    head = re.fullmatch(rb"(?:ST)?C?N?OFF\b(?!\s*BINARY)\s*(.*)", lines[0]) if lines else None
    if head is None:
        raise broken("it does not begin with OFF")
    lines = [head[1], *lines[1:]] if head[1] else lines[1:]
    sizes = lines[0].split() if lines else []
    if len(sizes) < 2 or not all(re.fullmatch(rb"\d{1,9}", word) for word in sizes[:2]):
        raise broken("it does not state its numbers of vertices and faces")
    many, count = int(sizes[0]), int(sizes[1])
    if len(lines) < 1 + many + count:
        raise broken("it is cut short")
    points = vectors(lines[1 : 1 + many], broken)
    counts, corners = [], []
    for line in lines[1 + many : 1 + many + count]:
        words = line.split()
        try:
            number = int(words[0])
            face = [int(word) for word in words[1 : 1 + number]] if number > 0 else []
        except ValueError as error:
            raise broken(f"{shown(line)} is no face") from error
        if not 0 < number <= MAX_POLYGON or len(face) < number:
            raise broken(f"{shown(line)} is no face")
        if not all(0 <= each < many for each in face):
            raise broken(f"the face {shown(line)} has a corner that is no vertex")
        if number >= 3:  # points and lines are no ground
            counts.append(number)
            corners.extend(face)
    lengths = np.array(counts, np.int64)
    require_few(int((lengths - 2).sum()))
    return points[triangulate(points, np.array(corners, np.int64), lengths, broken)]
