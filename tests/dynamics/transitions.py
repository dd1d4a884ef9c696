"""Transitions in other frames, and some of a batch; what is drawn at random, benchmarks draw."""

import jax
import numpy as np

from benchmarks.transitions.draws import FEET, drawn
from jaxleas.dynamics import BoundaryState, Reach, Supports, Transitions

__all__ = ["FEET", "moved", "random_transitions", "some_of"]

random_transitions = drawn


def moved(transitions: Transitions, matrix: np.ndarray, shift: np.ndarray) -> Transitions:
    """Return transitions in another frame: positions matrix p + shift, directions matrix d."""

    def state(old: BoundaryState) -> BoundaryState:
        return BoundaryState(
            old.com @ matrix.T + shift, old.velocity @ matrix.T, old.acceleration @ matrix.T
        )

    points, normals, ahead, standing = transitions.supports
    rows = transitions.reach.rows @ matrix.T
    return Transitions(
        state(transitions.start),
        state(transitions.end),
        transitions.durations,
        Supports(points @ matrix.T + shift, normals @ matrix.T, ahead @ matrix.T, standing),
        Reach(rows, transitions.reach.bounds + rows @ shift),
        transitions.limits,
    )


def some_of(transitions: Transitions, which: slice) -> Transitions:
    """Return some of a batch; limits that are numbers stay."""
    return jax.tree.map(lambda each: each[which] if np.ndim(each) else each, transitions)
