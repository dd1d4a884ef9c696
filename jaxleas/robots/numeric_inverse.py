"""The inverse kinematics of any chain by damped Newton steps from a few starts, in batches."""

import numpy as np
from jaxtyping import Bool, Float

from jaxleas.robots.chain import SerialChain, chain_jacobian, chain_posture

REACHED = 1e-9
"""A pose counts as reached within this distance [m] and angle [rad]."""
STARTS = 512
"""Number of postures from which each pose takes its nearest starts."""
_ATTEMPTS = 6
_STEPS = 20
_PATIENCE = 6  # steps in which a search must halve its error, or it ends
_DAMPING = 1e-3  # damping of a step, as a share of the remaining error
_LONGEST = 0.4  # a joint turns by no more than this in a step [rad]
_ARM = 0.3  # a turn of one radian counts as much as this distance [m]
_AT_ONCE = 4096


def draw_starts(chain: SerialChain, reference: Float[np.ndarray, " J"]) -> Float[np.ndarray, "S J"]:
    """Return the start postures of searches: the reference, and a fixed random sample."""
    drawn = np.random.default_rng(0).uniform(chain.lower, chain.upper, (STARTS, len(chain)))
    drawn[0] = reference
    return drawn


def numeric_inverse(
    chain: SerialChain,
    starts: Float[np.ndarray, "S J"],
    position: Float[np.ndarray, "N 3"],
    rotation: Float[np.ndarray, "N 3 3"] | None,
) -> tuple[Float[np.ndarray, "N J"], Bool[np.ndarray, " N"]]:
    """Return joint angles within the limits that bring the effector to poses.

    An answer that is found is a solution; a failed search does not prove that none exists.

    Args:
        chain: chain of joints.
        starts: postures to start from [rad].
        position: position of the effector in the root frame [m].
        rotation: orientation of the effector in the root frame; None to accept any.

    Returns:
        The angles [rad], and whether the pose is reached; angles of a pose that is not reached are
        the last ones tried.
    """
    angles = np.empty((len(position), len(chain)))
    reached = np.zeros(len(position), dtype=bool)
    for first in range(0, len(position), _AT_ONCE):
        rows = slice(first, first + _AT_ONCE)
        turn = None if rotation is None else rotation[rows]
        angles[rows], reached[rows] = _search(chain, starts, position[rows], turn)
    return angles, reached


def _search(
    chain: SerialChain, starts: np.ndarray, position: np.ndarray, rotation: np.ndarray | None
) -> tuple[np.ndarray, np.ndarray]:
    near = nearest_starts(chain, starts, position, rotation)
    angles, reached = starts[near[:, 0]].copy(), np.zeros(len(position), dtype=bool)
    # No pose is in reach at a distance from the first joint above the stretched chain's length.
    offsets = np.concatenate([chain.positions[1:], chain.tip.position[None]])
    length = float(np.linalg.norm(offsets, axis=1).sum())
    near_enough = np.linalg.norm(position - chain.positions[0], axis=1) <= length + REACHED
    for attempt in range(near.shape[1]):
        open_ = np.flatnonzero(near_enough & ~reached)
        if not len(open_):
            break
        turn = None if rotation is None else rotation[open_]
        begin = starts[near[open_, attempt]]
        angles[open_], reached[open_] = newton_inverse(chain, begin, position[open_], turn)
    return angles, reached


def nearest_starts(
    chain: SerialChain, starts: np.ndarray, position: np.ndarray, rotation: np.ndarray | None
) -> np.ndarray:
    """Return the indices of the starts nearest to each pose, best first."""
    posture = chain_posture(chain, starts)
    apart = position[:, None] - posture.tip
    cost = (apart * apart).sum(axis=2)
    if rotation is not None:  # trace of R^T R' = 1 + 2 cos(angle between them)
        trace = rotation.reshape(-1, 9) @ posture.tip_rotation.reshape(-1, 9).T
        cost = cost + _ARM**2 * (3.0 - trace)
    count = min(_ATTEMPTS, len(starts))
    best = np.argpartition(cost, count - 1, axis=1)[:, :count]
    order = np.take_along_axis(cost, best, axis=1).argsort(axis=1)
    return np.take_along_axis(best, order, axis=1)


def newton_inverse(
    chain: SerialChain,
    angles: Float[np.ndarray, "N J"],
    position: Float[np.ndarray, "N 3"],
    rotation: Float[np.ndarray, "N 3 3"] | None,
) -> tuple[Float[np.ndarray, "N J"], Bool[np.ndarray, " N"]]:
    """Return what `numeric_inverse` returns, each search from one start.

    Args:
        chain: chain of joints.
        angles: posture that each search starts from [rad].
        position: position of the effector in the root frame [m].
        rotation: orientation of the effector in the root frame; None to accept any.
    """
    angles, going = angles.copy(), np.arange(len(angles))
    reached = np.zeros(len(angles), dtype=bool)
    used = 3 if rotation is None else 6
    first = np.zeros(len(angles))
    for step_number in range(_STEPS):
        posture = chain_posture(chain, angles[going])
        error = position[going] - posture.tip
        if rotation is not None:
            turn = _turn_between(posture.tip_rotation, rotation[going])
            error = np.concatenate([error, turn], axis=1)
        left = np.abs(error).max(axis=1)
        if step_number == 0:
            first = left.copy()
        done = left <= REACHED
        reached[going[done]] = True
        if step_number == _PATIENCE:
            done = done | (left > 0.5 * first[going])
        if done.all():
            break
        going, error, left = going[~done], error[~done], left[~done]
        jacobian = chain_jacobian(chain, posture)[~done][:, :used]
        transposed = jacobian.transpose(0, 2, 1)
        damped = jacobian @ transposed + (_DAMPING * left**2)[:, None, None] * np.eye(used)
        # Rows that the chain cannot move at all must not make the matrix singular.
        damped += 1e-14 * np.eye(used)
        step = (transposed @ np.linalg.solve(damped, error[:, :, None]))[:, :, 0]
        longest = np.abs(step).max(axis=1, keepdims=True)
        step *= np.minimum(1.0, _LONGEST / np.maximum(longest, 1e-12))
        angles[going] = np.clip(angles[going] + step, chain.lower, chain.upper)
    return angles, reached


def _turn_between(
    start: Float[np.ndarray, "N 3 3"], end: Float[np.ndarray, "N 3 3"]
) -> Float[np.ndarray, "N 3"]:
    """Return the rotation vector that turns `start` into `end` [rad]; half turns are cut short."""
    turn = end @ start.transpose(0, 2, 1)
    vector = 0.5 * np.stack(
        [
            turn[:, 2, 1] - turn[:, 1, 2],
            turn[:, 0, 2] - turn[:, 2, 0],
            turn[:, 1, 0] - turn[:, 0, 1],
        ],
        axis=1,
    )
    sine = np.linalg.norm(vector, axis=1)
    cosine = 0.5 * (np.trace(turn, axis1=1, axis2=2) - 1.0)
    angle = np.arctan2(sine, cosine)
    return vector * np.where(sine > 1e-9, angle / np.maximum(sine, 1e-9), 1.0)[:, None]
