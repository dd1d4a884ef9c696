"""OBJ files as triangles: vertices and faces, read from untrusted files."""

import re
from collections.abc import Callable, Iterator

import numpy as np
from jaxtyping import Float

from jaxleas.terrain.faces import MAX_POLYGON, triangulate
from jaxleas.terrain.text_numbers import lines_of, shown, vectors
from jaxleas.types import InputError

_BATCH = 100_000  # faces parsed at a time, to save memory
_AFTER_SLASH = re.compile(rb"/\S*")  # texture and normal of a corner


def read_obj(
    content: bytes, broken: Callable[[str], InputError], require_few: Callable[[int], None]
) -> Float[np.ndarray, "N 3 3"]:
    """Return the triangles of an OBJ file, in the file's units.

    A backslash at the end of a line continues it. Concave faces keep their shape.

    Args:
        content: bytes of the file.
        broken: makes the error of a reason why the file cannot be read.
        require_few: refuses a number of triangles that is too large.
    """
    content = re.sub(rb"\\[ \t]*\r?\n", b" ", content)
    vertices: list[bytes] = []
    faces: list[bytes] = []
    known: list[int] = []  # vertices before each face: negative numbers count from there
    for line in lines_of(content):
        if line[:2] in (b"v ", b"v\t"):
            vertices.append(line[2:])
        elif line[:2] in (b"f ", b"f\t"):
            faces.append(line[2:])
            known.append(len(vertices))
    points = vectors(vertices, broken)
    parts = list(_parsed(faces, known, broken))
    counts = np.concatenate([count for count, _ in parts]) if parts else np.zeros(0, np.int64)
    require_few(int((counts - 2).sum()))
    corners = np.concatenate([corner for _, corner in parts]) if parts else np.zeros(0, np.int64)
    return points[triangulate(points, corners, counts, broken)]


def _parsed(
    faces: list[bytes], known: list[int], broken: Callable[[str], InputError]
) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    """Yield numbers of corners and indices of vertices, counted from 0, of some faces at a time."""
    for start in range(0, len(faces), _BATCH):
        some = faces[start : start + _BATCH]
        words = [_AFTER_SLASH.sub(b"", face).split() for face in some]
        counts = np.array([len(each) for each in words])
        odd = (counts < 3) | (counts > MAX_POLYGON)
        if odd.any():
            raise broken(f"a face has {counts[np.argmax(odd)]} corners")
        try:
            flat = [int(word) for each in words for word in each]
            numbers = np.array(flat, dtype=np.int64)
        except (ValueError, OverflowError) as error:
            raise broken(f"{_shown_unreadable(some, words)} is no face") from error
        before = np.repeat(np.array(known[start : start + _BATCH]), counts)
        # A corner 0 is invalid, and so becomes a negative index.
        indices = np.where(numbers > 0, numbers - 1, np.where(numbers < 0, before + numbers, -1))
        outside = (indices < 0) | (indices >= before)
        if outside.any():
            face = np.searchsorted(np.cumsum(counts), np.argmax(outside), side="right")
            raise broken(f"the face {shown(some[face])} has a corner that is no vertex before it")
        yield counts, indices


def _shown_unreadable(faces: list[bytes], words: list[list[bytes]]) -> str:
    for face, each in zip(faces, words, strict=True):
        if not all(re.fullmatch(rb"[+-]?\d{1,18}", word) for word in each):
            return shown(face)
    return shown(faces[0])
