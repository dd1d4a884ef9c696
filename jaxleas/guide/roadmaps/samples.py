"""The places that a search tries: drawn in blocks, read one by one, and known in advance."""

import numpy as np
from jaxtyping import Float

from jaxleas.guide.places import Places

BLOCK = 256
GOAL_EVERY = 20
"""One place in this number is the goal itself, if the search wants that: a bias of 5 %."""


class Samples:
    """An endless list of places; reading it again from the start gives the same ones."""

    def __init__(self, places: Places, seed: int, goal: Float[np.ndarray, " 2"] | None = None):
        """Prepare.

        Args:
            places: places where the robot can stand.
            seed: random seed of the list.
            goal: goal x, y to insert now and then; None for no goal [m].
        """
        self._places, self._goal = places, goal
        self._rng = np.random.default_rng(seed)
        self._drawn = np.zeros((0, 2))
        self.position = 0

    def next(self) -> Float[np.ndarray, " 2"]:
        """Return the next place and move on."""
        place = self.ahead(1)[0]
        self.position += 1
        return place

    def ahead(self, count: int) -> Float[np.ndarray, "count 2"]:
        """Return the next places without moving on."""
        while len(self._drawn) < self.position + count:
            block = self._places.draw(self._rng, BLOCK)
            if self._goal is not None:
                block[::GOAL_EVERY] = self._goal
            self._drawn = np.concatenate([self._drawn, block])
        return self._drawn[self.position : self.position + count]
