"""OBJ files as triangles: vertices and faces, read from untrusted files.

Long runs of lines of one kind are read as arrays; what is not plain numbers there, and all other
lines, are read one by one.
"""

import re
import warnings
from collections.abc import Callable, Iterator

import numpy as np
from jaxtyping import Float, Int

from jaxleas.terrain.meshes.faces import MAX_POLYGON, triangulate
from jaxleas.terrain.text_numbers import lines_of, shown, vectors
from jaxleas.types import InputError

Broken = Callable[[str], InputError]
LONG = 100
"""Number of lines of one kind that are read as an array."""
_BATCH = 100_000  # lines parsed at a time, to save memory
_AFTER_SLASH = re.compile(rb"/\S*")  # texture and normal of a corner
_OTHER, _VERTEX, _FACE = 0, 1, 2


def read_obj(
    content: bytes, broken: Broken, require_few: Callable[[int], None]
) -> Float[np.ndarray, "N 3 3"]:
    """Return the triangles of an OBJ file, in the file's units.

    A backslash at the end of a line continues it. Concave faces keep their shape.

    Args:
        content: bytes of the file.
        broken: makes the error of a reason why the file cannot be read.
        require_few: refuses a number of triangles that is too large.
    """
    points: list[np.ndarray] = []
    counts: list[np.ndarray] = []
    corners: list[np.ndarray] = []
    known = 0  # vertices so far: negative numbers count back from there
    for kind, count, text in _runs(_tidy(content)):
        if kind == _VERTEX:
            found = _plain_numbers(text, count, b"v") if count >= LONG else None
            if found is None or (found[0] != 3).any():
                points.append(vectors([line[2:] for line in lines_of(text)], broken))
            else:
                points.append(found[1].reshape(-1, 3))
            known += count
        else:
            number, indices = _face_corners(text, count, known, broken)
            counts.append(number)
            corners.append(indices)
    if not counts:
        return np.zeros((0, 3, 3))
    all_counts = np.concatenate(counts)
    require_few(int((all_counts - 2).sum()))
    vertices = np.concatenate(points)
    return vertices[triangulate(vertices, np.concatenate(corners), all_counts, broken)]


def _tidy(content: bytes) -> bytes:
    """Return the same lines, each ended by one line feed, not indented, and not continued."""
    if b"\\" in content:
        content = re.sub(rb"\\[ \t]*\r?\n", b" ", content)
    if b"\r" in content:
        content = content.replace(b"\r\n", b"\n").replace(b"\r", b"\n")
    if re.search(rb"(?m)^[ \t\v\f]", content):
        content = re.sub(rb"(?m)^[ \t\v\f]+", b"", content)
    return content if content.endswith(b"\n") else content + b"\n"


def _runs(content: bytes) -> Iterator[tuple[int, int, bytes]]:
    """Yield kind, number of lines and text of successive lines of vertices or of faces."""
    letters = np.frombuffer(content, np.uint8)
    ends = np.flatnonzero(letters == ord("\n"))
    starts = np.concatenate([[0], ends[:-1] + 1])
    first, second = letters[starts], letters[np.minimum(starts + 1, len(letters) - 1)]
    spaced = (second == ord(" ")) | (second == ord("\t"))
    kind = np.where(spaced & (first == ord("v")), _VERTEX, _OTHER)
    kind = np.where(spaced & (first == ord("f")), _FACE, kind)
    changes = np.concatenate([[0], np.flatnonzero(np.diff(kind)) + 1, [len(kind)]])
    for begin, end in zip(changes[:-1].tolist(), changes[1:].tolist(), strict=True):
        if kind[begin] == _OTHER:
            continue
        for at in range(begin, end, _BATCH):
            last = min(at + _BATCH, end)
            yield int(kind[begin]), last - at, content[starts[at] : ends[last - 1] + 1]


def _face_corners(
    text: bytes, count: int, known: int, broken: Broken
) -> tuple[Int[np.ndarray, " F"], Int[np.ndarray, " C"]]:
    """Return the numbers of corners of faces, and the indices of their vertices from 0."""
    found = _plain_faces(text, count) if count >= LONG else None
    if found is None:
        found = _words_of_faces([line[2:] for line in lines_of(text)], broken)
    counts, numbers = found
    # A corner 0 is invalid, and so becomes a negative index.
    indices = np.where(numbers > 0, numbers - 1, np.where(numbers < 0, known + numbers, -1))
    outside = (indices < 0) | (indices >= known)
    if outside.any():
        face = int(np.searchsorted(np.cumsum(counts), np.argmax(outside), side="right"))
        line = text.splitlines()[face][2:]
        raise broken(f"the face {shown(line)} has a corner that is no vertex before it")
    return counts, indices


def _plain_faces(
    text: bytes, count: int
) -> tuple[Int[np.ndarray, " F"], Int[np.ndarray, " C"]] | None:
    found = _plain_numbers(_AFTER_SLASH.sub(b"", text) if b"/" in text else text, count, b"f")
    if found is None:
        return None
    counts, numbers = found
    whole = (np.abs(numbers) < 2**53).all() and (numbers == np.trunc(numbers)).all()
    if not whole or ((counts < 3) | (counts > MAX_POLYGON)).any():
        return None
    return counts, numbers.astype(np.int64)


def _words_of_faces(
    faces: list[bytes], broken: Broken
) -> tuple[Int[np.ndarray, " F"], Int[np.ndarray, " C"]]:
    words = [[word.split(b"/", 1)[0] for word in face.split()] for face in faces]
    counts = np.array([len(each) for each in words])
    odd = (counts < 3) | (counts > MAX_POLYGON)
    if odd.any():
        raise broken(f"a face has {counts[np.argmax(odd)]} corners")
    for face, each in zip(faces, words, strict=True):
        if not all(re.fullmatch(rb"[+-]?\d{1,18}", word) for word in each):
            raise broken(f"{shown(face)} is no face")
    return counts, np.array([int(word) for each in words for word in each], dtype=np.int64)


def _plain_numbers(
    text: bytes, lines: int, letter: bytes
) -> tuple[Int[np.ndarray, " L"], Float[np.ndarray, " K"]] | None:
    """Return how many numbers each line has after its letter, and all numbers; None: not plain."""
    text = text.translate(None, letter)
    letters = np.frombuffer(text, np.uint8)
    blank = letters <= ord(" ")
    begins = np.flatnonzero(~blank & np.concatenate([[True], blank[:-1]]))
    line = np.searchsorted(np.flatnonzero(letters == ord("\n")), begins)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # that it stopped at a word: then some are missing
        try:
            numbers = np.fromstring(text, np.float64, sep=" ")
        except ValueError:
            return None
    if len(numbers) != len(begins):
        return None
    return np.bincount(line, minlength=lines), numbers
