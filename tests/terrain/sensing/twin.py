"""Slow NumPy twins of filling, holes and smooth noise; they share no code with the package."""

import numpy as np

VOID = -10_000.0


def fill_slowly(heights, missing, widest):
    """Return heights with narrow gaps filled, and what is still missing, cell by cell."""
    rows, columns = heights.shape
    found, left = heights.copy(), missing.copy()

    def end(row, column, down, right):
        """Return the height of the first known cell in a direction, and its distance."""
        steps = 0
        while True:
            row, column, steps = row + down, column + right, steps + 1
            if not (0 <= row < rows and 0 <= column < columns):
                return VOID, steps
            if not missing[row, column]:
                return heights[row, column], steps

    for row, column in zip(*np.nonzero(missing), strict=True):
        candidates = []
        for down, right in ((1, 0), (0, 1)):
            low, before = end(row, column, -down, -right)
            high, after = end(row, column, down, right)
            if before + after - 1 <= widest:
                void = min(low, high) <= VOID
                line = np.interp(before, [0, before + after], [low, high])
                candidates.append(VOID if void else line)
        left[row, column] = not candidates
        found[row, column] = VOID
        if candidates and min(candidates) > VOID:
            found[row, column] = np.mean(candidates)
    return found, left


def squares_slowly(corner, side):
    """Return the cells in squares whose highest row and column are given."""
    covered = np.zeros_like(corner)
    for row, column in zip(*np.nonzero(corner), strict=True):
        covered[max(0, row - side + 1) : row + 1, max(0, column - side + 1) : column + 1] = True
    return covered


def smooth_slowly(white, correlation):
    """Return white noise convolved with a periodic Gaussian, which has sum of squares 1."""
    rows, columns = white.shape
    reach = np.arange(-4, 5)

    def kernel(count):
        """Periodic Gaussian of deviation correlation / 2 along one axis."""
        away = np.arange(count)[:, None] + reach * count
        return np.exp(-2.0 * (away / correlation) ** 2).sum(axis=1)

    gaussian = np.outer(kernel(rows), kernel(columns))
    gaussian /= np.sqrt((gaussian**2).sum())
    smooth = np.zeros_like(white)
    for row in range(rows):
        for column in range(columns):
            smooth += gaussian[row, column] * np.roll(white, (row, column), axis=(0, 1))
    return smooth
