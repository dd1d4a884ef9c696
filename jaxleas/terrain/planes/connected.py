"""Cells that hang together by their sides."""

from typing import cast

import numpy as np
from jaxtyping import Bool, Int

SIDES = np.array([[0, 1, 0], [1, 1, 1], [0, 1, 0]])
"""Cells that a cell hangs together with."""


def connected(cells: Bool[np.ndarray, "R C"]) -> tuple[Int[np.ndarray, "R C"], int]:
    """Return the number of the set that each cell belongs to, 0 for none, and the count of sets."""
    from scipy.ndimage import label

    return cast(tuple[np.ndarray, int], label(cells, SIDES))
