"""Rings along the edges of cells."""

from collections.abc import Iterator

import numpy as np
from jaxtyping import Bool, Int

Corner = tuple[int, int]


def rings(cells: Bool[np.ndarray, "R C"]) -> list[Int[np.ndarray, "N 2"]]:
    """Return closed rings along the edges of cells, the cells to the left of each.

    Corner (x, y) is the lower left corner of the cell in column x and row y. The outer ring of
    cells that share edges runs counter-clockwise; rings of holes run clockwise.
    """
    steps: dict[Corner, list[Corner]] = {}
    for corner, step in _sides(cells):
        steps.setdefault(corner, []).append(step)
    found = []
    while steps:
        found.append(np.array(_ring(steps, next(iter(steps)))))
    return found


def _sides(cells: Bool[np.ndarray, "R C"]) -> Iterator[tuple[Corner, Corner]]:
    """Yield the first corner and the step of each side between a cell and what is none."""
    padded = np.pad(cells, 1)
    # Row and column of the neighbour across the side; from the cell to the side's first corner.
    for down, right, x, y in ((-1, 0, 0, 0), (0, 1, 1, 0), (1, 0, 1, 1), (0, -1, 0, 1)):
        rows, columns = cells.shape
        beside = padded[1 + down : 1 + down + rows, 1 + right : 1 + right + columns]
        row, column = np.nonzero(cells & ~beside)
        step = (-down, right)
        for corner in zip((column + x).tolist(), (row + y).tolist(), strict=True):
            yield corner, step


def _ring(steps: dict[Corner, list[Corner]], start: Corner) -> list[Corner]:
    """Return the ring from a corner on; its steps are taken out of `steps`.

    Where two rings touch, the ring turns left and stays on its cell.
    """
    ring, here, first = [start], start, steps[start][0]
    step = first
    while True:
        steps[here].remove(step)
        if not steps[here]:
            del steps[here]
        here = (here[0] + step[0], here[1] + step[1])
        left = (-step[1], step[0])
        if here == start and (start not in steps or first == left):
            return ring
        ring.append(here)
        step = left if left in steps[here] else steps[here][0]
