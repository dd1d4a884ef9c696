"""The ground as a walking robot feels it: the plane through its last footholds."""

from dataclasses import dataclass
from typing import Self

import numpy as np
from jaxtyping import Float

STEEPEST = 0.6
"""Largest slope that is believed, along each axis; feet that are close together tell little."""
_FIRM = 1e-3
"""What is added to the spread of the feet, so that the slope of feet in one line is 0 across it
[m2]."""


@dataclass(frozen=True, eq=False)
class GroundPlane:
    """A plane under each of N robots.

    Attributes:
        middle: a point of it, the mean of the footholds [m].
        gradient: how much it rises per metre along x and y.
    """

    middle: Float[np.ndarray, "N 3"]
    gradient: Float[np.ndarray, "N 2"]

    @classmethod
    def through(cls, footholds: Float[np.ndarray, "N E 3"]) -> Self:
        """Return the planes with the least squared vertical distances from the footholds."""
        middle = footholds.mean(axis=1)
        arms = footholds - middle[:, None]
        flat, heights = arms[..., :2], arms[..., 2:]
        turned = np.swapaxes(flat, 1, 2)
        spread = turned @ flat + _FIRM * np.eye(2)
        gradient = np.linalg.solve(spread, turned @ heights)[..., 0]
        return cls(middle, np.clip(gradient, -STEEPEST, STEEPEST))

    def height_at(self, places: Float[np.ndarray, "N E 2"]) -> Float[np.ndarray, "N E"]:
        """Return the heights of the planes at places [m].

        Args:
            places: horizontal coordinates, some for each robot [m].
        """
        away = places - self.middle[:, None, :2]
        return self.middle[:, None, 2] + (away @ self.gradient[..., None])[..., 0]
