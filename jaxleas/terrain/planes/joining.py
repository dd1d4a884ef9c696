"""Neighbouring regions that one plane fits as well as two are joined."""

import numpy as np
from jaxtyping import Float, Int

from jaxleas.terrain.planes.plane import fitted
from jaxleas.terrain.planes.region import Growth, Region

SAME = 0.3
"""Increase of the mean squared distance by joining, in variances of the noise, up to which two
planes are one: about planes that lie half a standard deviation apart."""
TRIMMED = 3.0
"""Standard deviations beyond which a cell does not count in a fit."""


def regions_of(ground: Growth, owner: Int[np.ndarray, "R C"]) -> list[Region]:
    """Return the regions of numbered cells with their planes, fitted without outliers.

    Args:
        ground: heights and noise.
        owner: number of the region of each cell, from 1; 0 for none.
    """
    from scipy.ndimage import find_objects

    found = []
    for number, box in enumerate(find_objects(owner), start=1):
        if box is None:
            continue
        cells = (owner[box] == number) & ground.known[box]
        if cells.sum() < 3:
            continue
        plane = fitted(ground.heights[box], cells, box)
        gap = np.abs(ground.heights[box] - plane.over(box))
        near = cells & (gap <= TRIMMED * ground.noise)
        if 0.5 * cells.sum() <= near.sum() < cells.sum():
            plane = fitted(ground.heights[box], near, box)
        found.append(Region(plane, box, cells))
    return found


def joined(ground: Growth, owner: Int[np.ndarray, "R C"]) -> Int[np.ndarray, "R C"]:
    """Return numbered cells where regions of one plane that touch have one number.

    Args:
        ground: heights and noise.
        owner: number of the region of each cell, from 1; 0 for none.
    """
    moments = _moments(ground, owner)
    pairs = neighbours(owner)
    if not len(pairs):
        return owner
    costs = _cost(moments[pairs[:, 0]], moments[pairs[:, 1]])
    most = SAME * ground.noise**2
    leader = np.arange(len(moments))
    for index in np.argsort(costs, kind="stable"):
        if costs[index] > most:
            break
        low, high = sorted(int(_leader(leader, each)) for each in pairs[index])
        if low != high and _cost(moments[[low]], moments[[high]])[0] <= most:
            leader[high] = low
            moments[low] += moments[high]
    return np.array([_leader(leader, each) for each in range(len(leader))], np.int32)[owner]


def _moments(ground: Growth, owner: Int[np.ndarray, "R C"]) -> Float[np.ndarray, "N 4 4"]:
    """Return sums of products of (1, row, column, height) over the cells of each region."""
    row, column = np.nonzero(owner)
    number = owner[row, column]
    values = np.stack([np.ones(len(row)), row, column, ground.heights[row, column]])
    values[1:3] -= np.array(owner.shape)[:, None] / 2.0
    count = int(owner.max()) + 1
    sums = np.zeros((count, 4, 4))
    for i in range(4):
        for j in range(i + 1):
            sums[:, i, j] = sums[:, j, i] = np.bincount(number, values[i] * values[j], count)
    return sums


def _cost(one: Float[np.ndarray, "P 4 4"], other: Float[np.ndarray, "P 4 4"]) -> np.ndarray:
    """Return by how much the squared distances increase by joining, per cell of the smaller."""
    cells = np.minimum(one[:, 0, 0], other[:, 0, 0])
    return (_rest(one + other) - _rest(one) - _rest(other)) / np.maximum(cells, 1.0)


def _rest(moments: Float[np.ndarray, "P 4 4"]) -> np.ndarray:
    """Return the sum of squared distances from the plane of least squares."""
    normal = moments[:, :3, :3] + 1e-9 * np.eye(3)
    plane = np.linalg.solve(normal, moments[:, :3, 3:])[..., 0]
    return moments[:, 3, 3] - (plane * moments[:, :3, 3]).sum(axis=1)


def neighbours(owner: Int[np.ndarray, "R C"]) -> Int[np.ndarray, "P 2"]:
    """Return the pairs of regions with cells side by side."""
    found = []
    for one, other in ((owner[:-1], owner[1:]), (owner[:, :-1], owner[:, 1:])):
        differ = (one != other) & (one > 0) & (other > 0)
        found.append(np.stack([one[differ], other[differ]], axis=1))
    return np.unique(np.sort(np.concatenate(found), axis=1), axis=0)


def _leader(leader: Int[np.ndarray, " N"], number: int) -> int:
    while leader[number] != number:
        number = int(leader[number])
    return number
