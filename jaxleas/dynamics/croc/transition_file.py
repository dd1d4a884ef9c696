"""Transition files: one contact transition as JSON, checked key by key."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal

import numpy as np
from pydantic import Field, ValidationError
from scipy.spatial.transform import Rotation

from jaxleas.configuration import Positive, Strict
from jaxleas.dynamics.croc.transitions import (
    GRAVITY,
    NO_FORCE_LIMIT,
    BoundaryState,
    Discretisation,
    Limits,
    Reach,
    Supports,
    Transitions,
)
from jaxleas.files import read_json
from jaxleas.types import InputError

_CORNERS = ((1, 1), (1, -1), (-1, 1), (-1, -1))
_NO_ROW = 10.0  # bound of a padded row [m]
_MOST_PHASES, _MOST_CONTACTS, _MOST_ROWS = 100, 100, 10_000
_UNIT = 1e-6

Vector = tuple[float, float, float]


class _Contact(Strict):
    position: Vector
    orientation: tuple[float, float, float, float] = (1.0, 0.0, 0.0, 0.0)
    half_size: tuple[Annotated[float, Field(ge=0)], Annotated[float, Field(ge=0)]] = (0.0, 0.0)


class _Reach(Strict):
    rows: list[Vector] = Field(max_length=_MOST_ROWS)
    bounds: list[float]


class _Phase(Strict):
    duration: Positive
    contacts: list[_Contact] = Field(max_length=_MOST_CONTACTS)
    reach: _Reach | None = None


class _State(Strict):
    com: Vector
    velocity: Vector = (0.0, 0.0, 0.0)
    acceleration: Vector = (0.0, 0.0, 0.0)


class _File(Strict):
    mass: Positive
    friction: Positive
    start: _State
    end: _State
    phases: list[_Phase] = Field(min_length=1, max_length=_MOST_PHASES)
    acceleration_limit: Positive = 10.0
    force_limit: Positive | None = None
    degree: Literal[4, 6] = 4
    kind: Literal["instants", "everywhere"] = "instants"
    instants: Annotated[int, Field(ge=2, le=1000)] = 4
    pieces: Annotated[int, Field(ge=1, le=100)] = 1
    generators: Annotated[int, Field(ge=3, le=64)] = 4


@dataclass(frozen=True)
class TransitionFile:
    """One transition as a file states it.

    Attributes:
        transition: the transition, without a batch axis.
        discretisation: where it is checked.
        mass: mass of the robot [kg].
    """

    transition: Transitions
    discretisation: Discretisation
    mass: float


def read_transition(path: str | Path) -> TransitionFile:
    """Read a transition file; docs/transitions.md states its keys.

    Raises:
        InputError: the file is missing or no JSON object, or a key is missing or unusable; the
            message names both.
    """
    content = read_json(path)
    if not isinstance(content, dict):
        raise InputError(f"{path} is no transition file: it needs an object of start, end, phases")
    try:
        stated = _File.model_validate(content)
    except ValidationError as error:
        first = error.errors()[0]
        raise InputError(f"{path}: {_key(first['loc'])}: {first['msg']}") from error
    points = max(1, *(sum(len(_corners(each)) for each in p.contacts) for p in stated.phases))
    rows = max(1, *(len(phase.reach.rows) if phase.reach else 0 for phase in stated.phases))
    supports, reach = [], []
    for index, phase in enumerate(stated.phases):
        where = f"{path}: phases.{index}"
        supports.append(_support(where, phase, points))
        reach.append(_reach(where, phase, rows))
    weight = stated.mass * GRAVITY
    limit = NO_FORCE_LIMIT if stated.force_limit is None else stated.force_limit / weight
    start, end = (
        BoundaryState(*(np.array(part) for part in (s.com, s.velocity, s.acceleration)))
        for s in (stated.start, stated.end)
    )
    transition = Transitions(
        start,
        end,
        np.array([phase.duration for phase in stated.phases]),
        Supports(*(np.array(part) for part in zip(*supports, strict=True))),
        Reach(*(np.array(part) for part in zip(*reach, strict=True))),
        Limits(stated.friction, stated.acceleration_limit, limit),
    )
    discretisation = Discretisation(
        stated.degree, stated.kind, stated.instants, stated.pieces, stated.generators
    )
    return TransitionFile(transition, discretisation, stated.mass)


def _support(
    where: str, phase: _Phase, points: int
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Return points, normals, first axes and standing of one phase, padded."""
    found: list[tuple[np.ndarray, np.ndarray, np.ndarray]] = []
    for index, contact in enumerate(phase.contacts):
        quaternion = np.array(contact.orientation)
        if abs(np.linalg.norm(quaternion) - 1.0) > _UNIT:
            raise InputError(
                f"{where}.contacts.{index}.orientation: the unit quaternion (w, x, y, z) has length"
                f" {np.linalg.norm(quaternion):.6g}, not 1"
            )
        turn = Rotation.from_quat(quaternion, scalar_first=True).as_matrix()
        for corner in _corners(contact):
            local = np.array([*(corner * np.array(contact.half_size)), 0.0])
            found.append((np.array(contact.position) + turn @ local, turn[:, 2], turn[:, 0]))
    arrays = [np.zeros((points, 3)) for _ in range(3)]
    for k, each in enumerate(found):
        for array, value in zip(arrays, each, strict=True):
            array[k] = value
    return arrays[0], arrays[1], arrays[2], np.arange(points) < len(found)


def _corners(contact: _Contact) -> list[np.ndarray]:
    """Return the corners of a rectangle or of an edge, in units of its half size; a point's one."""
    sides = {
        tuple(np.array(corner) * (np.array(contact.half_size) > 0.0)): None for corner in _CORNERS
    }
    return [np.array(side) for side in sides]


def _reach(where: str, phase: _Phase, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Return rows of unit length, and bounds, of one phase, padded."""
    rows, bounds = np.zeros((1, count, 3)), np.full((1, count), _NO_ROW)
    if phase.reach is not None:
        given = len(phase.reach.rows)
        if given != len(phase.reach.bounds):
            raise InputError(
                f"{where}.reach: {given} rows and {len(phase.reach.bounds)} bounds: give one bound"
                " for each row"
            )
        length = np.linalg.norm(np.array(phase.reach.rows).reshape(-1, 3), axis=1)
        if (length < _UNIT).any():
            raise InputError(f"{where}.reach.rows.{int(length.argmin())} has no direction")
        rows[0, :given] = np.array(phase.reach.rows).reshape(-1, 3) / length[:, None]
        bounds[0, :given] = np.array(phase.reach.bounds) / length
    return rows, bounds


def _key(location: tuple[int | str, ...]) -> str:
    return ".".join(map(str, location)) or "file"
