"""PLY files as triangles: text or binary, read from untrusted files."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from jaxtyping import Float

from jaxleas.terrain.faces import MAX_POLYGON, triangulate
from jaxleas.terrain.text_numbers import shown
from jaxleas.types import InputError

Broken = Callable[[str], InputError]
MAX_ROWS = 20_000_000
MAX_HEADER = 100_000
_TYPES = {
    "char": "i1", "int8": "i1", "uchar": "u1", "uint8": "u1", "short": "i2", "int16": "i2",
    "ushort": "u2", "uint16": "u2", "int": "i4", "int32": "i4", "uint": "u4", "uint32": "u4",
    "float": "f4", "float32": "f4", "double": "f8", "float64": "f8",
}  # fmt: skip
_FACES = ("vertex_indices", "vertex_index")
Columns = dict[str, Any]
"""Values of a property by its name: an array, or for a list (numbers of values, all values)."""


@dataclass
class _Element:
    """A kind of rows: name and type of each property; of a list also the type of its count."""

    name: str
    rows: int
    properties: list[tuple[str, str, str | None]] = field(default_factory=list)


def read_ply(
    content: bytes, broken: Broken, require_few: Callable[[int], None]
) -> tuple[Float[np.ndarray, "N 3 3"], bool]:
    """Return the triangles of a PLY file in the file's units, and whether they are 32-bit numbers.

    Args:
        content: bytes of the file.
        broken: makes the error of a reason why the file cannot be read.
        require_few: refuses a number of triangles that is too large.
    """
    layout, elements, body = _header(content, broken)
    read = (
        _rows_of_text(body, broken) if layout == "ascii" else _rows_of_bytes(body, layout, broken)
    )
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


def _header(content: bytes, broken: Broken) -> tuple[str, list[_Element], bytes]:
    """Return the byte order or "ascii", the elements, and the bytes after the header."""
    end = content.find(b"end_header", 0, MAX_HEADER)
    if content[:3] != b"ply" or end < 0:
        raise broken("it does not begin like one")
    layout, elements = "", []
    for line in content[3:end].splitlines():
        words = line.decode(errors="replace").split()
        match words:
            case ["format", "ascii", *_]:
                layout = "ascii"
            case ["format", "binary_little_endian", *_]:
                layout = "<"
            case ["format", "binary_big_endian", *_]:
                layout = ">"
            case ["element", name, number] if number.isdecimal() and len(number) < 10:
                elements.append(_Element(name, int(number)))
            case ["property", "list", count, kind, name] if (
                elements and _TYPES.get(count, "f4")[0] != "f" and kind in _TYPES
            ):
                elements[-1].properties.append((name, _TYPES[kind], _TYPES[count]))
            case ["property", kind, name] if elements and kind in _TYPES:
                elements[-1].properties.append((name, _TYPES[kind], None))
            case [] | ["comment" | "obj_info", *_]:
                pass
            case _:
                raise broken(f"its header has the line {shown(line)}")
    body = content[end + len(b"end_header") :]
    start = 2 if body[:2] == b"\r\n" else 1
    if not layout or any(each.rows > MAX_ROWS for each in elements):
        raise broken("its header states no format, or too many rows")
    if any(not each.properties for each in elements):
        raise broken("its header has an element without properties")
    return layout, elements, body[start:]


def _rows_of_bytes(body: bytes, order: str, broken: Broken) -> Callable[[_Element], Columns]:
    at = 0

    def read(element: _Element) -> Columns:
        nonlocal at
        counts = _first_counts(body, at, order, element, broken) if element.rows else {}
        parts: list[Any] = []
        for name, kind, count in element.properties:
            if count is not None:
                parts.append((f"{name} count", order + count))
            size = (counts.get(name, 0),)
            parts.append((name, order + kind) if count is None else (name, order + kind, size))
        if len({part[0] for part in parts}) < len(parts):
            raise broken("its header names a property twice")
        row = np.dtype(parts)
        end = at + element.rows * row.itemsize
        if end <= len(body):
            table = np.frombuffer(body, row, element.rows, at)
            if all((table[f"{name} count"] == number).all() for name, number in counts.items()):
                at = end
                return {
                    name: table[name]
                    if count is None
                    else (np.full(element.rows, counts.get(name, 0)), table[name].reshape(-1))
                    for name, _, count in element.properties
                }
        columns, at = _row_by_row(body, at, order, element, broken)
        return columns

    return read


def _first_counts(
    body: bytes, at: int, order: str, element: _Element, broken: Broken
) -> dict[str, int]:
    """Return how long the lists in the first row are; most files have them all alike."""
    counts = {}
    for name, kind, count in element.properties:
        if count is not None:
            counts[name] = _number(body, at, order + count, broken)
            at += np.dtype(count).itemsize
        at += np.dtype(kind).itemsize * counts.get(name, 1)
    return counts


def _row_by_row(
    body: bytes, at: int, order: str, element: _Element, broken: Broken
) -> tuple[Columns, int]:
    values: dict[str, list[Any]] = {name: [] for name, _, _ in element.properties}
    kinds = [
        (name, np.dtype(order + kind), None if count is None else np.dtype(order + count))
        for name, kind, count in element.properties
    ]
    for _ in range(element.rows):
        for name, kind, count in kinds:
            number = 1
            if count is not None:
                number = _number(body, at, count, broken)
                at += count.itemsize
            if at + number * kind.itemsize > len(body):
                raise broken("it is cut short")
            values[name].append(np.frombuffer(body, kind, number, at))
            at += number * kind.itemsize
    return {name: _joined(values[name], count) for name, _, count in kinds}, at


def _number(body: bytes, at: int, kind: Any, broken: Broken) -> int:
    size = np.dtype(kind).itemsize
    if at + size > len(body):
        raise broken("it is cut short")
    number = int(np.frombuffer(body, kind, 1, at)[0])
    if not 0 <= number <= len(body):
        raise broken("a list has an impossible length")
    return number


def _rows_of_text(body: bytes, broken: Broken) -> Callable[[_Element], Columns]:
    words = iter(body.split())

    def read(element: _Element) -> Columns:
        lists = [name for name, _, count in element.properties if count is not None]
        try:
            if not lists:
                width = len(element.properties)
                table = np.array(list(_taken(words, element.rows * width, broken)), "S32")
                numbers = table.astype(np.float64).reshape(element.rows, width)
                return {each[0]: numbers[:, at] for at, each in enumerate(element.properties)}
            values: dict[str, list[Any]] = {name: [] for name, _, _ in element.properties}
            for _ in range(element.rows):
                for name, _, count in element.properties:
                    number = 1 if count is None else int(next(_taken(words, 1, broken)))
                    if not 0 <= number <= len(body):
                        raise broken("a list has an impossible length")
                    values[name].append([float(word) for word in _taken(words, number, broken)])
        except ValueError as error:
            raise broken(f"it holds something that is no number: {str(error)[:60]}") from error
        return {name: _joined(values[name], count) for name, _, count in element.properties}

    return read


def _taken(words: Iterator[bytes], number: int, broken: Broken) -> Iterator[bytes]:
    for _ in range(number):
        word = next(words, None)
        if word is None:
            raise broken("it is cut short")
        yield word


def _joined(values: list[Any], count: Any) -> Any:
    flat = np.concatenate([np.asarray(each) for each in values]) if values else np.zeros(0)
    if count is None:
        return flat
    with np.errstate(invalid="ignore"):
        return np.array([len(each) for each in values], np.int64), flat
