"""Where planes begin to grow: in flat windows with enough others next to them."""

from collections.abc import Iterator

import numpy as np
from jaxtyping import Bool

from jaxleas.terrain.planes.connected import connected
from jaxleas.terrain.planes.windows import Windows

MANY = 1000
"""Number of seeds that are looked at together: most are taken by then."""


def large(cells: Bool[np.ndarray, "R C"], least: int) -> Bool[np.ndarray, "R C"]:
    """Return the cells that hang together with enough others."""
    components, _ = connected(cells)
    enough = np.bincount(components.reshape(-1)) >= least
    enough[0] = False
    return enough[components]


def flattest_first(seeds: Bool[np.ndarray, "R C"], windows: Windows) -> Iterator[tuple[int, int]]:
    """Yield the places of seeds, the flattest windows first, unless taken out by then."""
    cells = np.flatnonzero(seeds)
    cells = cells[np.argsort(windows.deviation.reshape(-1)[cells], kind="stable")]
    left = seeds.reshape(-1)  # the same memory
    for first in range(0, len(cells), MANY):
        some = cells[first : first + MANY]
        for cell in some[left[some]].tolist():
            if left[cell]:
                yield divmod(cell, seeds.shape[1])
