"""Footsteps as they end while robots walk, by the definition that motion models are fitted to."""

import numpy as np
from jaxtyping import Int

from jaxleas.footsteps.extraction import SHORTEST, SWUNG, TOUCHES, swing_time
from jaxleas.physics import Sensed
from jaxleas.types import ControllerIdentity

NONE, UNCLEAR = -1, -2
"""What `ContactWatch.update` returns where no footstep ended, and where one did in which not just
one pair of feet swung."""


class ContactWatch:
    """Finds the ends of footsteps of N robots by measured contact alone.

    A footstep ends when all feet touch the ground again, as in `extract_footsteps`; it is known
    at that tick.

    Args:
        controller: identity of the controller that walks.
        robots: number of robots.
    """

    def __init__(self, controller: ControllerIdentity, robots: int) -> None:
        feet = len(controller.feet)
        self._pairs = np.zeros((len(controller.pairs), feet), dtype=bool)
        for pair, members in enumerate(controller.pairs):
            self._pairs[pair, list(members)] = True
        self._least_rise = SWUNG * controller.swing_height
        self._shortest = SHORTEST * swing_time(controller)
        self._stood = np.zeros(robots, dtype=bool)
        self._begun = np.full(robots, np.nan)
        self._lift_off = np.zeros((robots, feet))
        self._highest = np.zeros((robots, feet))

    def update(self, sensed: Sensed) -> Int[np.ndarray, " N"]:
        """Return the pair that swung where a footstep has just ended; else `NONE` or `UNCLEAR`.

        Args:
            sensed: measurements of this tick.
        """
        heights, stand = sensed.feet[..., 2], (sensed.forces > TOUCHES).all(axis=1)
        first = stand & np.isnan(self._begun)
        self._highest = np.maximum(self._highest, heights)
        ended = stand & ~self._stood & (sensed.time - self._begun >= self._shortest)
        self._stood = stand
        swung = (self._highest - self._lift_off) > self._least_rise
        same = (swung[:, None] == self._pairs).all(axis=2)
        pair = np.where(same.any(axis=1), same.argmax(axis=1), UNCLEAR)
        begins = first | ended
        self._begun = np.where(begins, sensed.time, self._begun)
        self._lift_off = np.where(begins[:, None], heights, self._lift_off)
        self._highest = np.where(begins[:, None], heights, self._highest)
        return np.where(ended, pair, NONE)
