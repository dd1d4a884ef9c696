"""Lists of boxes in YAML: stepping stones, stairs and beams, tilted or level."""

from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float

from jaxleas.configuration import read_mapping
from jaxleas.terrain.meshes.solids import box_triangles, placed
from jaxleas.types import InputError

MAX_BOXES = 100_000
_NAMES = {
    "top": ("top",),
    "centre": ("centre", "center", "position", "pos"),
    "normal": ("normal",),
    "size": ("size", "dimensions", "dims"),
    "yaw": ("yaw",),
}
_PARTS = "[[x, y, z], [normal x, y, z], [length, width, height], [yaw]]"


def read_boxes(path: Path) -> Float[np.ndarray, "N 3 3"]:
    """Return the triangles of the boxes in a YAML file [m].

    Its one list, under any name, has a box an entry: `[[x, y, z], [normal], [length, width,
    height], [yaw]]` with the middle of the top face, out of which the normal points, or a mapping
    of `top` (that middle) or `centre` (of the box), `size` and, if it is turned, `normal` and
    `yaw`. The yaw [rad] turns the box before it is tilted.

    Raises:
        InputError: the file is not such a list; the message says where.
    """
    lists = {name: each for name, each in read_mapping(path).items() if isinstance(each, list)}
    if len(lists) != 1:
        raise InputError(
            f"{path} has {len(lists)} lists; a terrain of boxes has one, such as 'boxes'"
        )
    ((name, entries),) = lists.items()
    if not 0 < len(entries) <= MAX_BOXES:
        raise InputError(f"{path}: '{name}' holds {len(entries)} boxes; 1 to {MAX_BOXES} are read")
    return np.concatenate(
        [_box(f"{path}: box {index} of '{name}'", each) for index, each in enumerate(entries)]
    )


def _box(where: str, entry: Any) -> Float[np.ndarray, "12 3 3"]:
    parts = _named(where, entry) if isinstance(entry, dict) else _listed(where, entry)
    middle = "top" if "top" in parts else "centre"
    at, normal, size = (_numbers(where, parts[name], 3) for name in (middle, "normal", "size"))
    yaw = parts["yaw"] if isinstance(parts["yaw"], list) else [parts["yaw"]]
    angle = float(_numbers(where, yaw, 1)[0])
    length = float(np.linalg.norm(normal))
    if not ((size > 0.0).all() and length > 0.0):
        raise InputError(f"{where} needs a positive size, and a normal that is not 0")
    cos, sin = np.cos(angle), np.sin(angle)
    turn = np.array([[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]])
    box = box_triangles(0.5 * size)
    if middle == "top":
        box = box - [0.0, 0.0, 0.5 * size[2]]
    return placed(box, _tilt(normal / length) @ turn, at)


def _listed(where: str, entry: Any) -> dict[str, Any]:
    if not isinstance(entry, list) or len(entry) not in (3, 4):
        raise InputError(f"{where} is no {_PARTS}")
    return dict(zip(("top", "normal", "size", "yaw"), [*entry, [0.0]], strict=False))


def _named(where: str, entry: dict[str, Any]) -> dict[str, Any]:
    found: dict[str, Any] = {"normal": [0.0, 0.0, 1.0], "yaw": [0.0]}
    for key, value in entry.items():
        name = next((name for name, words in _NAMES.items() if key in words), None)
        if name is None:
            raise InputError(f"{where} has the unknown key '{key}'; known are {', '.join(_NAMES)}")
        found[name] = value
    if ("top" in found) == ("centre" in found) or "size" not in found:
        raise InputError(f"{where} needs 'size', and either 'top' or 'centre'")
    return found


def _numbers(where: str, value: Any, count: int) -> Float[np.ndarray, " K"]:
    plain = isinstance(value, list) and len(value) == count
    if not plain or any(isinstance(v, bool) or not isinstance(v, int | float) for v in value):
        raise InputError(f"{where} is no {_PARTS}: {str(value)[:40]} should be {count} numbers")
    numbers = np.array(value, np.float64)
    if not (np.abs(numbers) < 1e6).all():
        raise InputError(f"{where} has a number beyond 1000 km")
    return numbers


def _tilt(normal: Float[np.ndarray, " 3"]) -> Float[np.ndarray, "3 3"]:
    """Return the rotation that takes z to a unit normal and leaves x in the plane y = 0."""
    x = np.array([normal[2], 0.0, -normal[0]])
    if not np.linalg.norm(x) > 1e-9:  # a normal along y
        x = np.array([1.0, 0.0, 0.0])
    x /= np.linalg.norm(x)
    return np.column_stack([x, np.cross(normal, x), normal])
