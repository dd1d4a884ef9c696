"""The slow twins' curve: evaluated by SciPy at given times, for any free point, and no more.

Shares no code with `curves` and `program`: how anything depends on the free point is found by
evaluating it for four of them, since it is affine.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from jaxtyping import Float
from scipy.interpolate import BPoly

from jaxleas.dynamics.croc.transitions import Transitions

_GRAVITY = np.array([0.0, 0.0, -9.81])  # [m/s^2]


@dataclass(frozen=True)
class Moment:
    """The centre of mass at some times: position [m], acceleration [m/s^2], wrench over weight."""

    com: Float[np.ndarray, "K 3"]
    acceleration: Float[np.ndarray, "K 3"]
    wrench: Float[np.ndarray, "K 6"]


def one_of(transitions: Transitions, index: int | tuple[int, ...]) -> Transitions:
    """Return one transition of a batch; limits become numbers."""
    batch = np.shape(transitions.durations)[:-1]

    def pick(value: Any) -> Any:
        return (
            type(value)(*(pick(part) for part in value))
            if isinstance(value, tuple)
            else (np.asarray(value)[index])
        )

    limits = type(transitions.limits)(
        *(float(np.broadcast_to(value, batch)[index]) for value in transitions.limits)
    )
    start, end, durations, supports, reach = (pick(value) for value in transitions[:-1])
    return Transitions(start, end, durations, supports, reach, limits)


def moment(
    transition: Transitions, degree: int, free_point: np.ndarray, times: np.ndarray
) -> Moment:
    """Return where the centre of mass is at some times, and what moves it there.

    Args:
        transition: one transition.
        degree: degree of the curve.
        free_point: free control point in the world [m].
        times: times since the beginning [s].
    """
    span = [0.0, float(np.sum(transition.durations))]
    kept = degree // 2  # position, velocity, and the acceleration if the degree is 6
    ends = [[np.asarray(part, np.float64) for part in end[:kept]] for end in transition[:2]]
    # The curve one degree lower that keeps both ends, and what the free point adds to it.
    lower = BPoly.from_derivatives(span, ends)
    middle = (lower.c[kept - 1, 0] + lower.c[kept, 0]) / 2.0
    bump = BPoly(np.eye(degree + 1)[kept][:, None], span)
    moved = np.asarray(free_point) - middle
    com = lower(times) + bump(times)[:, None] * moved
    acceleration = lower.derivative(2)(times) + bump.derivative(2)(times)[:, None] * moved
    force = (acceleration - _GRAVITY) / 9.81
    return Moment(com, acceleration, np.concatenate([force, np.cross(com, force)], axis=1))


def bernstein_points(values: Float[np.ndarray, "K D"], at: np.ndarray) -> Float[np.ndarray, "K D"]:
    """Return the control points of the polynomial curve with given values at K fractions."""
    count = len(at)
    columns = [BPoly(np.eye(count)[k][:, None], [0.0, 1.0])(at) for k in range(count)]
    return np.linalg.solve(np.column_stack(columns), values)
