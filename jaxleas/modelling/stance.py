"""The reference stance of a leg: a level sole below the hip, at a height stated or found."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from jaxleas.modelling.legs import FEW_JOINTS, knee_of
from jaxleas.robots import SerialChain, chain_posture, newton_inverse
from jaxleas.types import InputError

_DRAWN = 20_000
_STARTS = 1024
_NEAR = 0.1
"""Share of a leg's length within which a sole counts as below its hip."""
_LEVEL = np.cos(np.deg2rad(10.0))
UPRIGHT, CROUCHED = 0.95, 0.8
"""Height of the root of a biped with soles, and of other robots, as a share of that with stretched
legs."""


@dataclass(frozen=True, eq=False)
class Target:
    """Where the sole of a leg is to be.

    Attributes:
        chain: joints down to the sole.
        flat: whether the sole must be level.
        place: middle of the sole in the root frame [m].
        near: angles that the posture is to be near to [rad]; None for 0.
    """

    chain: SerialChain
    flat: bool
    place: Float[np.ndarray, " 3"]
    near: Float[np.ndarray, " J"] | None = None


def stretched_height(chain: SerialChain, flat: bool, at: Float[np.ndarray, " 2"]) -> float:
    """Return how far below the root a leg reaches near a place [m]; nan where it does not.

    Args:
        chain: joints down to the sole.
        flat: whether the sole must be level.
        at: horizontal place in the root frame [m].
    """
    rng = np.random.default_rng(0)
    angles = rng.uniform(chain.lower, chain.upper, (_DRAWN, len(chain)))
    angles[0] = np.clip(0.0, chain.lower, chain.upper)
    posture = chain_posture(chain, angles)
    offsets = np.concatenate([chain.positions[1:], chain.tip.position[None]])
    length = float(np.linalg.norm(offsets, axis=1).sum())
    near = np.linalg.norm(posture.tip[:, :2] - at, axis=1) <= _NEAR * length
    if flat:
        near &= posture.tip_rotation[:, 2, 2] >= _LEVEL
    return float(-posture.tip[near, 2].min()) if near.any() else float("nan")


def stand(target: Target) -> Float[np.ndarray, " J"] | None:
    """Return the angles nearest to others that bring a sole to its place; None where none do.

    Of two as near, the one whose knee is nearer to the middle of the robot.
    """
    chain = target.chain
    rng = np.random.default_rng(0)
    starts = rng.uniform(chain.lower, chain.upper, (_STARTS, len(chain)))
    starts[0] = np.clip(0.0, chain.lower, chain.upper)
    places = np.broadcast_to(target.place, (_STARTS, 3))
    turns = np.broadcast_to(np.eye(3), (_STARTS, 3, 3)) if target.flat else None
    angles, reached = newton_inverse(chain, starts, places, turns)
    if not reached.any():
        return None
    angles = angles[reached]
    near = np.clip(0.0, chain.lower, chain.upper) if target.near is None else target.near
    knee = chain_posture(chain, angles).origins[:, knee_of(chain)]
    cost = ((angles - near) ** 2).sum(axis=1) + 0.01 * np.abs(knee[:, 0])
    return angles[np.argmin(np.round(cost, 6))]


def require_stance(target: Target, link: str) -> Float[np.ndarray, " J"]:
    """Return what `stand` does.

    Raises:
        InputError: the place is not reached.
    """
    angles = stand(target)
    if angles is None:
        x, y, z = np.round(target.place, 3).tolist()
        level = " level" if target.flat else ""
        few = (
            f"; a leg of {len(target.chain)} joints may need the angles of a stance, `reference`"
            if FEW_JOINTS < len(target.chain) < 6
            else ""
        )
        raise InputError(
            f"the leg of '{link}' does not bring its sole{level} to ({x}, {y}, {z}) m in the root"
            " frame, where the reference stance would have it: state root_height, reference_sole,"
            f" or the angles of a stance by `reference`{few}"
        )
    return angles
