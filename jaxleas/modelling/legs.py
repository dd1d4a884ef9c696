"""The legs of a URDF: their joints down to the sole, their knees, and which are mirror images."""

from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float

from jaxleas.robots import SerialChain, chain_posture

_SAME = 1e-5
"""Tolerance of lengths, axes and angles of two legs that are mirror images [m, 1 and rad]."""
FEW_JOINTS = 4
"""Up to so many joints cannot lay a sole flat: the foot touches with a point."""


@dataclass(frozen=True, eq=False)
class Leg:
    """A leg.

    Attributes:
        limb: name of the limb, such as "left".
        foot: name of the effector, such as "LF".
        link: link or frame of the URDF that was named.
        chain: joints from the root to the middle of the sole.
        flat: whether the foot stands with a sole.
        half_size: half length and half width of the sole [m]; zeros for a point foot.
        reference: angles in the reference stance [rad].
        straight: angle of the knee as the leg is straight [rad].
        mirror_of: index of the leg before it that it is the mirror image of; None for none.
    """

    limb: str
    foot: str
    link: str
    chain: SerialChain
    flat: bool
    half_size: tuple[float, float]
    reference: Float[np.ndarray, " J"]
    straight: float
    mirror_of: int | None = None

    @property
    def knee(self) -> int:
        """Index of the knee among the joints."""
        return knee_of(self.chain)

    @property
    def sole(self) -> Float[np.ndarray, " 3"]:
        """Middle of the sole in the root frame, in the reference stance [m]."""
        return chain_posture(self.chain, self.reference).tip

    @property
    def side(self) -> float:
        """1 for a leg left of the root, -1 for one right of it."""
        return 1.0 if self.sole[1] >= 0.0 else -1.0

    def bent(self, least: float) -> SerialChain:
        """Return the chain with the knee bent by `least` [rad] or more, as in the reference."""
        if len(self.chain) < 2:
            return self.chain
        lower, upper, knee = self.chain.lower.copy(), self.chain.upper.copy(), self.knee
        if self.reference[knee] >= self.straight:
            lower[knee] = min(max(lower[knee], self.straight + least), upper[knee])
        else:
            upper[knee] = max(min(upper[knee], self.straight - least), lower[knee])
        return replace(self.chain, lower=lower, upper=upper)


def knee_of(chain: SerialChain) -> int:
    """Return the index of the joint that is far both from the first one and from the tip."""
    posture = chain_posture(chain, np.zeros(len(chain)))
    first, tip = posture.origins[0], posture.tip
    nearer = np.minimum(
        np.linalg.norm(posture.origins - first, axis=1),
        np.linalg.norm(posture.origins - tip, axis=1),
    )
    return int(np.argmax(np.round(nearer, 6)))


def straight_knee(chain: SerialChain) -> float:
    """Return the angle of the knee that brings hip, knee and ankle into one plane, stretched [rad].

    Of all turns, the one nearest to the middle of the knee's limits.
    """
    knee = knee_of(chain)
    posture = chain_posture(chain, np.zeros(len(chain)))
    at, places = posture.origins[knee], [*posture.origins[knee + 1 :], posture.tip]
    reach = max(float(np.linalg.norm(posture.tip - at)), 1e-9)
    below = next((p - at for p in places if np.linalg.norm(p - at) > 0.1 * reach), places[-1] - at)
    axis = posture.frames[knee] @ chain.axes[knee]
    away = at - posture.origins[0]  # where the shank would continue the thigh
    away, below = (each - axis * (axis @ each) for each in (away, below))
    angle = float(np.arctan2(axis @ np.cross(below, away), below @ away))
    middle = 0.5 * float(chain.lower[knee] + chain.upper[knee])
    return angle + 2.0 * np.pi * round((middle - angle) / (2.0 * np.pi))


def is_mirror_image(one: SerialChain, other: SerialChain) -> bool:
    """Tell whether a chain is the mirror image of another one, joint by joint."""
    if len(one) != len(other):
        return False
    image = one.mirrored()
    pairs = (
        (image.positions, other.positions),
        (image.rotations, other.rotations),
        (image.axes, other.axes),
        (image.lower, other.lower),
        (image.upper, other.upper),
        (image.tip.position, other.tip.position),
        (image.tip.rotation, other.tip.rotation),
    )
    return all(np.abs(a - b).max() <= _SAME for a, b in pairs)


def limb_names(places: Float[np.ndarray, "F 3"], links: tuple[str, ...]) -> list[tuple[str, str]]:
    """Return name of limb and of foot for each foot, given places in the root frame [m]."""
    if len(places) == 2:
        return [("left", "LF"), ("right", "RF")]
    if len(places) == 4:
        return [(each, each) for each in ("LF", "RF", "LH", "RH")]
    return [(link, link) for link in links]


def order_of(places: Float[np.ndarray, "F 3"]) -> list[int]:
    """Return the order of feet: left before right, of four the front ones first."""
    count = len(places)
    if count == 4:
        front = sorted(range(4), key=lambda index: -places[index][0])
        pairs = front[:2], front[2:]
        return [each for pair in pairs for each in sorted(pair, key=lambda i: -places[i][1])]
    if count == 2:
        return sorted(range(2), key=lambda index: -places[index][1])
    return list(range(count))
