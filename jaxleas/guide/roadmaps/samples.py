"""The places that a search tries: drawn in blocks, read one by one, known in advance."""

import numpy as np
from jaxtyping import Float

from jaxleas.guide.places import Places

BLOCK = 256
GOAL_EVERY = 20
"""Each so manieth place is the goal itself, where the search asks for that: a bias of 5 %."""


class Samples:
    """An endless list of places; reading it again from the start gives the same ones."""

    def __init__(self, places: Places, seed: int, goal: Float[np.ndarray, " 2"] | None = None):
        """Prepare.

        Args:
            places: that can be stood at.
            seed: of the list.
            goal: to be put in between, if at all [m].
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
