"""Queries as files: starts and goals (docs/files.md)."""

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from jaxleas.files import read_json
from jaxleas.terrain import HeightMap
from jaxleas.types import InputError, Query, is_ground

MAX_QUERIES = 100_000
MAX_ABOVE_GROUND = 2.0  # a root higher than this [m] is given in other units or in another frame
MAX_COORDINATE = 1e4  # likewise [m]; float32 still distinguishes millimetres there
MAX_SPEED = 10.0  # likewise [m/s]
AROUND = 1.0
"""Half of the side of a square around a start in which some ground must be known [m]."""

_LENGTHS = {"position": 3, "yaw": 0, "velocity": 3, "goal": 2}  # 0: a plain number
_BOUNDS = {
    "position": MAX_COORDINATE,
    "yaw": MAX_COORDINATE,
    "velocity": MAX_SPEED,
    "goal": MAX_COORDINATE,
}


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
            " in metres, seconds and radians, from where the terrain has x = y = 0: with --origin,"
            " from the point that it names"
        )
    return tuple(float(each) for each in numbers)


def require_on_terrain(path: str | Path, queries: Sequence[Query], terrain: HeightMap) -> None:
    """Refuse queries that start off the map, under the ground or far above it.

    A start over a hole of the map, or one that is merely invalid, is no mistake: its guide path is
    one invalid configuration. A goal may lie anywhere. A start with no ground at all around it is
    refused: the map knows nothing there.

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
        if not _has_ground_around(terrain, (x, y)):
            raise InputError(
                f"{where}, and all cells of the map within {AROUND:g} m of there are missing: start"
                " where some are known"
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


def _has_ground_around(terrain: HeightMap, place: tuple[float, float]) -> bool:
    """Return whether any cell of a square around a place has ground."""
    cell = [(at - low) / terrain.resolution for at, low in zip(place, terrain.origin, strict=True)]
    reach = AROUND / terrain.resolution
    columns, rows = (
        slice(max(0, math.ceil(each - reach)), max(0, math.floor(each + reach) + 1))
        for each in cell
    )
    return bool(is_ground(terrain.heights[rows, columns]).any())
