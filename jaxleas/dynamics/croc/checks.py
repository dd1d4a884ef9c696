"""Transitions are refused, in one sentence, where their shapes or numbers cannot be right."""

import numpy as np

from jaxleas.dynamics.croc.transitions import Discretisation, Transitions
from jaxleas.types import InputError

_UNIT = 1e-6
_SPACE = 3


def require_transitions(transitions: Transitions, discretisation: Discretisation) -> None:
    """Refuse transitions in NumPy arrays that no program can be made of.

    Args:
        transitions: transitions of any batch shape.
        discretisation: degree of the curve, and where it is checked.

    Raises:
        InputError: shapes disagree, or a number is not finite or out of range.
    """
    batch, phases = transitions.durations.shape[:-1], transitions.durations.shape[-1]
    _require_shapes(transitions, batch, phases)
    _require_instants(transitions, discretisation)
    states = [*transitions.start, *transitions.end]
    for name, arrays in (
        ("states at start and end", states),
        ("durations", [transitions.durations]),
        ("contact points, normals and first axes", transitions.supports[:3]),
        ("rows and bounds of reach", transitions.reach),
    ):
        if not all(np.isfinite(array).all() for array in arrays):
            raise InputError(f"{name} must be finite numbers")
    if not (transitions.durations > 0.0).all():
        least = float(transitions.durations.min())
        raise InputError(f"a phase lasts {least:g} s: durations must be positive")
    length = np.linalg.norm(transitions.supports.normals, axis=-1)
    if np.abs(length - 1.0).max(initial=0.0, where=transitions.supports.standing) > _UNIT:
        raise InputError("normals of contact points must have length 1")
    for name, value in transitions.limits._asdict().items():
        number = np.asarray(value, np.float64)
        if not (np.isfinite(number).all() and (number > 0.0).all()):
            raise InputError(f"the limit {name} is {value}: give a positive number")


def _require_shapes(transitions: Transitions, batch: tuple[int, ...], phases: int) -> None:
    points, rows = transitions.supports.points, transitions.reach.rows
    if phases < 1 or points.ndim < 3 or rows.ndim < 4:
        raise InputError(
            "give at least one phase, with contact points [S, P, 3] and reach [S, L, R, 3]"
        )
    support, reach = (*batch, phases, points.shape[-2]), (*batch, phases, *rows.shape[-3:-1])
    wanted = {
        "start.com": (transitions.start.com, (*batch, _SPACE)),
        "start.velocity": (transitions.start.velocity, (*batch, _SPACE)),
        "start.acceleration": (transitions.start.acceleration, (*batch, _SPACE)),
        "end.com": (transitions.end.com, (*batch, _SPACE)),
        "end.velocity": (transitions.end.velocity, (*batch, _SPACE)),
        "end.acceleration": (transitions.end.acceleration, (*batch, _SPACE)),
        "supports.points": (points, (*support, _SPACE)),
        "supports.normals": (transitions.supports.normals, (*support, _SPACE)),
        "supports.ahead": (transitions.supports.ahead, (*support, _SPACE)),
        "supports.standing": (transitions.supports.standing, support),
        "reach.rows": (rows, (*reach, _SPACE)),
        "reach.bounds": (transitions.reach.bounds, reach),
    }
    for name, (array, shape) in wanted.items():
        if array.shape != shape:
            raise InputError(
                f"{name} has shape {array.shape}; durations {transitions.durations.shape} ask for"
                f" {shape}"
            )


def _require_instants(transitions: Transitions, discretisation: Discretisation) -> None:
    given, wanted = transitions.reach.rows.shape[-3], discretisation.reach_instants
    if given not in (1, wanted):
        raise InputError(
            f"reach is given at {given} instants of each phase: give 1, or the {wanted} at which it"
            " is checked"
        )
