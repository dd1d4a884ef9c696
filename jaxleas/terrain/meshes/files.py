"""Mesh files as triangles: a small part of each format, read from untrusted files.

These are not trimesh's readers: for damaged files those raise arbitrary exceptions, print
tracebacks, take ten times the file's size in memory, and fill concave faces in.
"""

import logging
from functools import partial
from pathlib import Path
from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from jaxleas.files import read_bytes
from jaxleas.terrain.foreign.asking import ask
from jaxleas.terrain.meshes.boxes import read_boxes
from jaxleas.terrain.meshes.obj_files import read_obj
from jaxleas.terrain.meshes.off_files import read_off
from jaxleas.terrain.meshes.ply_files import read_ply
from jaxleas.terrain.reading import Up
from jaxleas.terrain.text_numbers import lines_of, vectors, without_mark
from jaxleas.types import InputError

_LOG = logging.getLogger("jaxleas")
MAX_TRIANGLES = 5_000_000
MAX_BYTES = 2**29
"""Five million triangles are 250 MB of binary STL, and about 350 MB of OBJ."""
_HEADER, _RECORD = 84, 50  # bytes of a binary STL: before the triangles, and per triangle


class Triangles(NamedTuple):
    """What a mesh file holds.

    Attributes:
        corners: triangles in the file's units.
        single: whether the file holds coordinates as 32-bit numbers, which are coarse far from
            the origin.
        up: axis that points up, unless the user says another one.
        gltf: whether y up is turned upright as glTF means it: x stays x, and z becomes -y.
    """

    corners: Float[np.ndarray, "N 3 3"]
    single: bool = False
    up: Up = "z"
    gltf: bool = False


def read_stl(path: Path) -> Triangles:
    """Return the triangles of an STL file, binary or text."""
    content = read_bytes(path, MAX_BYTES)
    if not content:
        raise _broken(path, "it is empty")
    count = int.from_bytes(content[80:84], "little") if len(content) >= _HEADER else 0
    if len(content) == _HEADER + _RECORD * count or _has_a_tail(content, count):
        _require_few(path, count)
        tail = len(content) - _HEADER - _RECORD * count
        if tail:
            _LOG.warning("%s: %d bytes after its %d triangles are left out", path, tail, count)
        return Triangles(_binary_stl(content, count), single=True)
    text = without_mark(content)
    if text.lstrip()[:5].lower() != b"solid":
        raise _broken(path, "its length is not that of the triangles it claims to hold")
    return Triangles(_text_stl(path, text))


def read_faces(path: Path) -> Triangles:
    """Return the triangles of an OBJ, OFF or PLY file, whose faces may have many corners."""
    content = without_mark(read_bytes(path, MAX_BYTES))
    broken, few = partial(_broken, path), partial(_require_few, path)
    match path.suffix.lower():
        case ".ply":
            return Triangles(*read_ply(content, broken, few))
        case ".off":
            return Triangles(read_off(content, broken, few))
        case _:
            return Triangles(read_obj(content, broken, few))


def read_glb(path: Path) -> Triangles:
    """Return the triangles of a GLB file, turned to z up if they are flat with y up.

    The format says that y points up; some programs write meshes with z up as they are.
    """
    arrays = ask("glb", path)
    flat = arrays["flat_area"]
    up = "y" if flat[1] >= flat[2] else "z"
    if up == "z":
        _LOG.warning("%s: its faces lie flat with z up, against the format: read so", path)
    return Triangles(arrays["triangles"], single=True, up=up, gltf=True)


def read_placed(path: Path) -> Triangles:
    """Return the triangles of a scene in metres with z up: MJCF, or a list of boxes."""
    if path.suffix.lower() == ".xml":
        return Triangles(ask("mjcf", path)["triangles"])
    return Triangles(read_boxes(path))


def _has_a_tail(content: bytes, count: int) -> bool:
    """Tell whether bytes follow the triangles of a binary STL that cannot be triangles.

    As many bytes as further triangles would take are an understated number, unless they are zero.
    """
    tail = content[_HEADER + _RECORD * count :]
    if not (count > 0 and _HEADER + _RECORD * count < len(content)):
        return False
    if without_mark(content).lstrip()[:5].lower() == b"solid" and b"facet" in content[:1024]:
        return False  # a text, whose 80th letters are no number
    return len(tail) % _RECORD != 0 or not tail.strip(b"\0")


def _binary_stl(content: bytes, count: int) -> Float[np.ndarray, "N 3 3"]:
    kind = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
    return np.frombuffer(content, kind, count, _HEADER)["corners"].astype(np.float64)


def _text_stl(path: Path, content: bytes) -> Float[np.ndarray, "N 3 3"]:
    if not content.rstrip().lower().splitlines()[-1:] or b"endsolid" not in content.lower():
        raise _broken(path, "it ends before endsolid")
    corners = [line[6:] for line in lines_of(content) if line[:6].lower() == b"vertex"]
    _require_few(path, len(corners) // 3)
    if len(corners) % 3:
        raise _broken(path, f"it has {len(corners)} vertices, which make no triangles of three")
    return vectors(corners, lambda reason: _broken(path, reason)).reshape(-1, 3, 3)


def _require_few(path: Path, count: int) -> None:
    if count > MAX_TRIANGLES:
        raise InputError(
            f"{path} has {count} triangles, more than the {MAX_TRIANGLES} accepted; decimate it"
            " first"
        )


def _broken(path: Path, reason: str) -> InputError:
    return InputError(f"{path} is not a readable {path.suffix[1:].lower()} mesh: {reason}")
