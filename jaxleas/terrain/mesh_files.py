"""STL and OBJ files as triangles: a small part of either format, read from untrusted files.

These are not trimesh's readers: for damaged files those raise arbitrary exceptions, print
tracebacks, and take ten times the file's size in memory.
"""

from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path

import numpy as np
from jaxtyping import Float

from jaxleas.files import read_bytes
from jaxleas.types.errors import InputError

MAX_TRIANGLES = 5_000_000
MAX_BYTES = 2**29
"""Five million triangles are 250 MB of binary STL, and about 350 MB of OBJ."""
MAX_POLYGON = 1000  # corners of one face
_HEADER, _RECORD = 84, 50  # bytes of a binary STL: before the triangles, and per triangle


def read_mesh(path: Path) -> Float[np.ndarray, "N 3 3"]:
    """Return the triangles of an .stl (binary or text) or .obj file, in the file's units.

    Raises:
        InputError: the file is missing, too large, damaged, or not of the kind that its suffix
            says.
    """
    content = read_bytes(path, MAX_BYTES)
    if path.suffix.lower() == ".obj":
        return _obj(path, content)
    if len(content) >= _HEADER:
        count = int.from_bytes(content[80:84], "little")
        if len(content) == _HEADER + _RECORD * count:
            _require_few(path, count)
            return _binary_stl(content)
    if content.lstrip()[:5].lower() != b"solid":
        raise _broken(path, "its length is not that of the triangles it claims to hold")
    return _text_stl(path, content)


def _binary_stl(content: bytes) -> Float[np.ndarray, "N 3 3"]:
    kind = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
    return np.frombuffer(content, kind, offset=_HEADER)["corners"].astype(np.float64)


def _text_stl(path: Path, content: bytes) -> Float[np.ndarray, "N 3 3"]:
    if not content.rstrip().lower().splitlines()[-1:] or b"endsolid" not in content.lower():
        raise _broken(path, "it ends before endsolid")
    corners = [line[6:] for line in _lines(content) if line[:6].lower() == b"vertex"]
    _require_few(path, len(corners) // 3)
    if len(corners) % 3:
        raise _broken(path, f"it has {len(corners)} vertices, which make no triangles of three")
    return _vectors(path, corners).reshape(-1, 3, 3)


def _obj(path: Path, content: bytes) -> Float[np.ndarray, "N 3 3"]:
    vertices, faces = [], []
    for line in _lines(content):
        if line[:2] in (b"v ", b"v\t"):
            vertices.append(line[2:])
        elif line[:2] in (b"f ", b"f\t"):
            # Negative numbers are relative to the vertices so far; -1 is the last.
            faces.append((line[2:], len(vertices)))
    points = _vectors(path, vertices)
    corners = [each for face, known in faces for each in _fan(path, face, known)]
    _require_few(path, len(corners))
    return points[np.array(corners, np.int64).reshape(-1, 3)]


def _fan(path: Path, face: bytes, known: int) -> Iterator[tuple[int, int, int]]:
    """Yield the triangles of a face as indices of vertices, counted from 0."""
    words = face.split()
    if not 3 <= len(words) <= MAX_POLYGON:
        raise _broken(path, f"a face has {len(words)} corners")
    try:
        numbers = [int(word.split(b"/", 1)[0]) for word in words]
    except ValueError as error:
        raise _broken(path, f"{_shown(face)} is no face") from error
    # A corner 0 is invalid, and so becomes a negative index.
    indices = [each - 1 if each > 0 else known + each if each else -1 for each in numbers]
    if not all(0 <= index < known for index in indices):
        raise _broken(path, f"the face {_shown(face)} has a corner that is no vertex before it")
    for second, third in pairwise(indices[1:]):
        yield indices[0], second, third


def _vectors(path: Path, texts: list[bytes]) -> Float[np.ndarray, "N 3"]:
    """Return the first three numbers of each text; colours and weights may follow."""
    words = [text.split()[:3] for text in texts]
    short = next((each for each in words if len(each) < 3), None)
    if short is not None:
        raise _broken(path, f"the vertex {_shown(b' '.join(short))} has fewer than 3 numbers")
    try:
        return np.array(words, dtype="S64").astype(np.float64).reshape(-1, 3)
    except ValueError as error:
        raise _broken(path, "a vertex is no three numbers") from error


def _lines(content: bytes) -> Iterator[bytes]:
    return (line.strip() for line in content.splitlines())


def _require_few(path: Path, count: int) -> None:
    if count > MAX_TRIANGLES:
        raise InputError(
            f"{path} has {count} triangles, more than the {MAX_TRIANGLES} accepted; decimate it"
            " first"
        )


def _broken(path: Path, reason: str) -> InputError:
    return InputError(f"{path} is not a readable {path.suffix[1:].lower()} mesh: {reason}")


def _shown(text: bytes) -> str:
    return ascii(text.decode(errors="replace"))[:60]
