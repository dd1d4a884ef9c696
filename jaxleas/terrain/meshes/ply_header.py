"""The header of a PLY file: its byte order, and the kinds of rows that follow."""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from jaxleas.terrain.text_numbers import shown
from jaxleas.types import InputError

Broken = Callable[[str], InputError]
"""Makes the error of a reason why a file cannot be read."""
MAX_ROWS = 20_000_000
MAX_HEADER = 100_000
TYPES = {
    "char": "i1", "int8": "i1", "uchar": "u1", "uint8": "u1", "short": "i2", "int16": "i2",
    "ushort": "u2", "uint16": "u2", "int": "i4", "int32": "i4", "uint": "u4", "uint32": "u4",
    "float": "f4", "float32": "f4", "double": "f8", "float64": "f8",
}  # fmt: skip
Columns = dict[str, Any]
"""Values of a property by its name: an array, or for a list (numbers of values, all values)."""


@dataclass
class Element:
    """A kind of rows: name and type of each property; of a list also the type of its count."""

    name: str
    rows: int
    properties: list[tuple[str, str, str | None]] = field(default_factory=list)


def read_header(content: bytes, broken: Broken) -> tuple[str, list[Element], bytes]:
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
                elements.append(Element(name, int(number)))
            case ["property", "list", count, kind, name] if (
                elements and TYPES.get(count, "f4")[0] != "f" and kind in TYPES
            ):
                elements[-1].properties.append((name, TYPES[kind], TYPES[count]))
            case ["property", kind, name] if elements and kind in TYPES:
                elements[-1].properties.append((name, TYPES[kind], None))
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


def joined(values: list[Any], count: Any) -> Any:
    """Return the values of a property in all rows: an array, or of a list its lengths, too."""
    flat = np.concatenate([np.asarray(each) for each in values]) if values else np.zeros(0)
    if count is None:
        return flat
    with np.errstate(invalid="ignore"):
        return np.array([len(each) for each in values], np.int64), flat
