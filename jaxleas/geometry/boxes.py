"""Boxes whose sides lie along the axes of a frame."""

from dataclasses import dataclass

import numpy as np

from jaxleas.types import InputError


@dataclass(frozen=True)
class Box:
    """An axis-aligned box.

    Attributes:
        low: smallest x, y, z [m].
        high: largest x, y, z [m].

    Raises:
        InputError: a number is not finite, or low is not below high.
    """

    low: tuple[float, float, float]
    high: tuple[float, float, float]

    def __post_init__(self) -> None:
        if not (np.shape(self.low) == np.shape(self.high) == (3,)):
            raise InputError(f"a box needs three numbers for each corner, got {self}")
        if not np.all(np.isfinite([self.low, self.high])) or np.any(
            np.asarray(self.low) >= np.asarray(self.high)
        ):
            raise InputError(f"a box needs finite corners with low below high, got {self}")
