"""Random transitions of a quadruped on nearly level ground, with boxes as reach."""

import numpy as np

from jaxleas.dynamics import BoundaryState, Limits, Reach, Supports, Transitions

FEET = np.array([[0.34, 0.2, 0.0], [0.34, -0.2, 0.0], [-0.34, 0.2, 0.0], [-0.34, -0.2, 0.0]])
HEIGHT = 0.45  # of the centre of mass over the feet [m]
AXES = np.concatenate([np.eye(3), -np.eye(3)])
HALF = np.array([0.15, 0.1, 0.1])  # of each foot's box of the centre of mass [m]
LIMITS = Limits(0.5, 10.0, 1.17)


def drawn(count: int, seed: int) -> Transitions:
    """Draw two phases each: four feet, then or before them three, or three and another three."""
    rng = np.random.default_rng(seed)
    sideways = rng.uniform(-0.1, 0.1, (count, 4, 2))
    feet = FEET + np.concatenate([sideways, rng.uniform(-0.03, 0.03, (count, 4, 1))], axis=-1)
    standing = np.ones((count, 2, 4), bool)
    lifted = rng.integers(4, size=(count, 2))
    each, kind = np.arange(count), rng.integers(3, size=count)
    standing[each, 1, lifted[:, 0]] = kind == 1  # touches down, or stays
    standing[each, 0, lifted[:, 1]] = kind == 0
    middle = feet.mean(axis=1) + np.array([0.0, 0.0, HEIGHT])
    start = middle + rng.uniform(-0.05, 0.05, (count, 3)) * [1, 1, 0]
    end = start + rng.uniform(-0.08, 0.08, (count, 3)) * [1, 1, 0]
    speed = rng.uniform(-0.2, 0.2, (2, count, 3)) * [1, 1, 0]
    points = np.broadcast_to(feet[:, None], (count, 2, 4, 3)).copy()
    rows = np.broadcast_to(AXES, (count, 2, 4, 6, 3)) * standing[..., None, None]
    home = points - FEET + np.array([0.0, 0.0, HEIGHT])
    bounds = np.where(standing[..., None], home @ AXES.T + np.tile(HALF, 2), 10.0)
    nothing = np.zeros((count, 3))
    return Transitions(
        BoundaryState(start, speed[0], nothing),
        BoundaryState(end, speed[1], nothing),
        rng.uniform(0.2, 1.5, (count, 2)),
        Supports(
            points,
            np.broadcast_to([0.0, 0.0, 1.0], points.shape).copy(),
            np.broadcast_to([1.0, 0.0, 0.0], points.shape).copy(),
            standing,
        ),
        Reach(rows.reshape(count, 2, 1, 24, 3), bounds.reshape(count, 2, 1, 24)),
        LIMITS,
    )
