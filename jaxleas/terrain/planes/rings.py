"""Rings along the edges of cells."""

import numpy as np
from jaxtyping import Bool, Int

STEPS = np.array([[1, 0], [0, 1], [-1, 0], [0, -1]])
"""Steps along sides, the cell to the left: ahead, then each a turn to the left of the last."""
ACROSS = np.array([[-1, 0], [0, 1], [1, 0], [0, -1]])
"""Row and column of the neighbour across the side."""
FIRST = np.array([[0, 0], [1, 0], [1, 1], [0, 1]])
"""From the cell to the corner at which the side begins."""


def rings(cells: Bool[np.ndarray, "R C"]) -> list[Int[np.ndarray, "N 2"]]:
    """Return closed rings along the edges of cells, the cells to the left of each.

    Corner (x, y) is the lower left corner of the cell in column x and row y. The outer ring of
    cells that share edges runs counter-clockwise; rings of holes run clockwise. Where two rings
    touch, each turns left and stays on its cell.
    """
    corner, way = _sides(cells)
    number = np.full((cells.shape[1] + 1, cells.shape[0] + 1, 4), -1)
    number[corner[:, 0], corner[:, 1], way] = np.arange(len(way))
    x, y = (corner + STEPS[way]).T
    follower = np.full(len(way), -1)
    for turn in (1, 0, -1):  # left, none, right
        found = number[x, y, (way + turn) % 4]
        follower = np.where(follower < 0, found, follower)
    return [corner[cycle] for cycle in _cycles(follower)]


def _sides(cells: Bool[np.ndarray, "R C"]) -> tuple[np.ndarray, np.ndarray]:
    """Return first corner and number of the step of each side between a cell and what is none."""
    padded = np.pad(cells, 1)
    rows, columns = cells.shape
    corners, ways = [], []
    for way, (down, right) in enumerate(ACROSS.tolist()):
        beside = padded[1 + down : 1 + down + rows, 1 + right : 1 + right + columns]
        row, column = np.nonzero(cells & ~beside)
        corners.append(np.stack([column, row], axis=1) + FIRST[way])
        ways.append(np.full(len(row), way))
    return np.concatenate(corners), np.concatenate(ways)


def _cycles(follower: Int[np.ndarray, " N"]) -> list[list[int]]:
    """Return the cycles in which each number follows another."""
    following, seen, found = follower.tolist(), [False] * len(follower), []
    for first in range(len(following)):
        cycle, here = [], first
        while not seen[here]:
            seen[here] = True
            cycle.append(here)
            here = following[here]
        if cycle:
            found.append(cycle)
    return found
