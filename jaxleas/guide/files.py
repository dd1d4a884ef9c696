"""Queries and guide paths as files (docs/files.md)."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal, get_args

import numpy as np

from jaxleas.files import read_json, read_npz, require_version_array, write_npz
from jaxleas.robots import RecordedRobot
from jaxleas.terrain import HeightMap
from jaxleas.types import Ending, GuidePath, InputError, Query, ending_of

Reason = Literal["reached", "invalid", "stopped"]

VERSION = 1  # version of guide path files
MAX_QUERIES = 100_000
MAX_ABOVE_GROUND = 2.0  # a root higher than this [m] is given in other units or in another frame
MAX_COORDINATE = 1e4  # likewise [m]; float32 still distinguishes millimetres there
MAX_SPEED = 10.0  # likewise [m/s]

_LENGTHS = {"position": 3, "yaw": 0, "velocity": 3, "goal": 2}  # 0: a plain number
_BOUNDS = {
    "position": MAX_COORDINATE,
    "yaw": MAX_COORDINATE,
    "velocity": MAX_SPEED,
    "goal": MAX_COORDINATE,
}


@dataclass(frozen=True)
class GuidePathFile:
    """Guide paths and how each ended.

    Attributes:
        paths: one guide path for each query.
        reasons: reason why each path ended; empty when the file does not say.
        robot: robot that walked; None in files from before robots were recorded.
    """

    paths: tuple[GuidePath, ...]
    reasons: tuple[Reason, ...]
    robot: RecordedRobot | None = None

    @property
    def endings(self) -> tuple[Ending, ...]:
        """How each path ended, as far as the file says."""
        said = self.reasons or ("",) * len(self.paths)
        return tuple(ending_of(path, each) for path, each in zip(self.paths, said, strict=True))


def read_queries(path: str | Path) -> list[Query]:
    """Read queries: a JSON list of {position, yaw, velocity, goal}.

    Raises:
        InputError: the file or one of its entries cannot be used; says which key of which query.
    """
    value = read_json(path)
    if not isinstance(value, list) or not value:
        raise InputError(
            f"{path} holds {'an empty list' if value == [] else type(value).__name__}: give a list"
            f" of queries, each with {', '.join(_LENGTHS)}"
        )
    if len(value) > MAX_QUERIES:
        raise InputError(f"{path} holds {len(value)} queries, more than {MAX_QUERIES} at once")
    return [_query(f"{path}: query {index}", entry) for index, entry in enumerate(value)]


def _query(where: str, entry: Any) -> Query:
    if not isinstance(entry, dict):
        raise InputError(f"{where} is no object with {', '.join(_LENGTHS)}: {entry!r:.60}")
    missing, unknown = _LENGTHS.keys() - entry.keys(), entry.keys() - _LENGTHS.keys()
    if missing:
        raise InputError(f"{where} lacks {', '.join(sorted(missing))}")
    if unknown:
        raise InputError(
            f"{where} has the unknown key {', '.join(sorted(map(repr, unknown)))}; known are"
            f" {', '.join(_LENGTHS)}"
        )
    values = {key: _numbers(where, key, entry[key]) for key in _LENGTHS}
    return Query(
        position=values["position"],  # type: ignore[arg-type]
        yaw=values["yaw"][0],
        velocity=values["velocity"],  # type: ignore[arg-type]
        goal=values["goal"],  # type: ignore[arg-type]
    )


def _numbers(where: str, key: str, value: Any) -> tuple[float, ...]:
    length = _LENGTHS[key]
    numbers = value if length else [value]
    if (
        not isinstance(numbers, list)
        or len(numbers) != max(length, 1)
        or any(isinstance(each, bool) or not isinstance(each, int | float) for each in numbers)
    ):
        wanted = f"a list of {length} numbers" if length else "a number"
        raise InputError(f"{where}: {key} must be {wanted}, not {value!r:.60}")
    if not all(math.isfinite(each) and abs(each) <= _BOUNDS[key] for each in numbers):
        raise InputError(
            f"{where}: {key} {value!r:.60} is not within +-{_BOUNDS[key]:g}; give finite numbers"
            " in metres, seconds and radians"
        )
    return tuple(float(each) for each in numbers)


def require_on_terrain(path: str | Path, queries: Sequence[Query], terrain: HeightMap) -> None:
    """Refuse queries that start off the map, under the ground or far above it.

    A start over a hole of the map, or one that is merely invalid, is no mistake: its guide path is
    one invalid configuration. A goal may lie anywhere.

    Args:
        path: file of the queries, for messages.
        queries: queries that the robot will walk.
        terrain: height map that the queries refer to.

    Raises:
        InputError: says which query, and where the map or the ground is.
    """
    x_min, x_max, y_min, y_max = terrain.extent
    ground = terrain.height_at(np.array([query.position[:2] for query in queries]))
    for index, (query, height) in enumerate(zip(queries, ground, strict=True)):
        x, y, z = query.position
        where = f"{path}: query {index} starts at x = {x:g}, y = {y:g}"
        if not (x_min <= x <= x_max and y_min <= y <= y_max):
            raise InputError(
                f"{where}, off the map, which spans x in [{x_min:g}, {x_max:g}] and y in"
                f" [{y_min:g}, {y_max:g}] m"
            )
        if z <= height:  # never true over a hole, whose height is NaN
            raise InputError(
                f"{where} with its root at {z:g} m, under the ground, which is at {height:g} m"
                " there; a root walks about a metre above ground"
            )
        if z > height + MAX_ABOVE_GROUND:
            raise InputError(
                f"{where} with its root at {z:g} m, more than {MAX_ABOVE_GROUND:g} m above the"
                f" ground, which is at {height:g} m there; a root walks about a metre above ground"
            )


def write_guide_paths(
    path: str | Path,
    guide_paths: Sequence[GuidePath],
    reasons: Sequence[Reason],
    waypoints: np.ndarray | None = None,
    robot: str | None = None,
) -> None:
    """Write guide paths end to end as .npz, whole or not at all.

    Args:
        path: file to write.
        guide_paths: one guide path for each query.
        reasons: reason why each path ended.
        waypoints: waypoints x and y of a single path, the goal last [m]; not read back.
        robot: name of the robot that walked, or path of its file; None: it is not recorded.
    """
    recorded = {} if robot is None else RecordedRobot.of(robot).to_arrays()
    lengths = [len(each) for each in guide_paths]
    write_npz(
        path,
        time=np.concatenate([each.time for each in guide_paths]).astype(np.float64),
        position=np.concatenate([each.position for each in guide_paths]).astype(np.float32),
        yaw=np.concatenate([each.yaw for each in guide_paths]).astype(np.float32),
        velocity=np.concatenate([each.velocity for each in guide_paths]).astype(np.float32),
        valid=np.concatenate([each.valid for each in guide_paths]).astype(bool),
        query=np.repeat(np.arange(len(lengths)), lengths),
        reached=np.array([reason == "reached" for reason in reasons]),
        reason=np.array(reasons, dtype=np.str_),
        version=np.array(VERSION),
        **recorded,
        **({} if waypoints is None else {"waypoints": np.asarray(waypoints, np.float64)}),
    )


def read_guide_paths(path: str | Path) -> GuidePathFile:
    """Read guide paths; a file without `query` is one path.

    Raises:
        InputError: the file lacks an array, or its arrays do not fit together.
    """
    required = ("time", "position", "yaw", "velocity", "valid")
    arrays = read_npz(path, required)
    require_version_array(arrays, VERSION, path)
    rows = arrays["time"].shape[0] if arrays["time"].ndim else 0
    shapes = {"position": (rows, 3), "velocity": (rows, 3)}
    arrays.setdefault("query", np.zeros(rows, np.int64))
    for name in (*required, "query"):
        kinds = {"valid": "b", "query": "iu"}.get(name, "f")
        expected = shapes.get(name, (rows,))
        array = arrays[name]
        if rows == 0 or array.shape != expected or array.dtype.kind not in kinds:
            raise InputError(
                f"{path}: {name} is {array.dtype} {array.shape}, where a guide path of {rows} rows"
                f" has shape {expected}"
            )
        if array.dtype.kind == "f" and not np.isfinite(array).all():
            raise InputError(f"{path}: {name} holds values that are not finite")
    first = np.flatnonzero(np.diff(arrays["query"], prepend=arrays["query"][0] - 1))
    if not np.array_equal(arrays["query"][first], np.arange(len(first))):
        raise InputError(f"{path}: query must count 0, 1, 2, ... through the rows")
    reasons = arrays.get("reason", np.array([], np.str_))
    if (
        reasons.ndim != 1
        or len(reasons) not in (0, len(first))
        or not set(reasons.tolist()) <= set(get_args(Reason))
    ):
        raise InputError(
            f"{path}: reason must say one of {', '.join(get_args(Reason))} for each of the"
            f" {len(first)} paths"
        )
    columns = [np.split(arrays[name], first[1:]) for name in required]
    guide_paths = tuple(GuidePath(*parts) for parts in zip(*columns, strict=True))
    return GuidePathFile(
        guide_paths, tuple(reasons.tolist()), RecordedRobot.from_arrays(arrays, path)
    )
