"""Where soles can stand: configurations drawn within a leg's joint limits, and what is kept."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float

from jaxleas.robots import SerialChain, chain_posture

AT_ONCE = 4_000
"""The frames of so many postures stay in a core's cache: more than twice as fast."""
CHUNK = 50 * AT_ONCE
"""Configurations between two reports of progress."""
REMEMBERED = 300_000
"""Number of kept configurations over which stances are drawn."""

Progress = Callable[[int], None]
"""Told how many further configurations were drawn."""


@dataclass(frozen=True)
class Standing:
    """Where the middle of a sole counts as standing, in the root frame.

    Attributes:
        tilt: largest slope of the sole [rad]; None for a point foot.
        top: largest height [m].
        low: smallest x and y [m].
        high: largest x and y [m].
    """

    tilt: float | None
    top: float
    low: tuple[float, float]
    high: tuple[float, float]

    def keeps(
        self, soles: Float[np.ndarray, "N 3"], upward: Float[np.ndarray, " N"]
    ) -> Bool[np.ndarray, " N"]:
        """Tell which soles could stand on walkable ground with the root upright.

        Args:
            soles: middles of soles [m].
            upward: z of each sole's normal.
        """
        kept = (soles[:, 2] <= self.top) & (soles[:, :2] >= self.low).all(axis=1)
        kept &= (soles[:, :2] <= self.high).all(axis=1)
        return kept if self.tilt is None else kept & (upward >= np.cos(self.tilt))


@dataclass(frozen=True, eq=False)
class Samples:
    """Configurations of a leg that stand.

    Attributes:
        soles: middles of the soles in the root frame [m].
        angles: joint angles of the first of them [rad].
        drawn: number of configurations that were drawn.
    """

    soles: Float[np.ndarray, "N 3"]
    angles: Float[np.ndarray, "M J"]
    drawn: int


def draw_standing(
    chain: SerialChain, standing: Standing, count: int, seed: int, progress: Progress
) -> Samples:
    """Draw configurations uniformly within the joint limits, and keep those that stand.

    Args:
        chain: joints down to the sole, knees bent enough.
        standing: what counts as standing.
        count: number of configurations.
        seed: seed of the draws.
        progress: told of each chunk.
    """
    rng, soles, angles, remembered = np.random.default_rng(seed), [], [], 0
    for start in range(0, count, CHUNK):
        drawn = rng.uniform(chain.lower, chain.upper, (min(CHUNK, count - start), len(chain)))
        places, upward = place_soles(chain, drawn)
        kept = standing.keeps(places, upward)
        soles.append(places[kept])
        angles.append(drawn[kept][: max(REMEMBERED - remembered, 0)])
        remembered += len(angles[-1])
        progress(len(drawn))
    return Samples(np.concatenate(soles), np.concatenate(angles), count)


def place_soles(
    chain: SerialChain, angles: Float[np.ndarray, "N J"]
) -> tuple[Float[np.ndarray, "N 3"], Float[np.ndarray, " N"]]:
    """Return the middle of each sole in the root frame [m], and z of its normal."""
    middles, upward = np.empty((len(angles), 3)), np.empty(len(angles))
    for start in range(0, len(angles), AT_ONCE):
        some = slice(start, start + AT_ONCE)
        posture = chain_posture(chain, angles[some])
        middles[some], upward[some] = posture.tip, posture.tip_rotation[:, 2, 2]
    return middles, upward
