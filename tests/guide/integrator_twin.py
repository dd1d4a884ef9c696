"""Minimum-time connections by integrating velocity profiles and bisecting, and nothing else."""

import numpy as np


def ramps(cruise, begin, end, bound):
    """Time and way of changing from `begin` to `cruise`, and from there to `end`, at the bound."""
    up, down = np.abs(cruise - begin) / bound, np.abs(cruise - end) / bound
    return up + down, up * (begin + cruise) / 2 + down * (cruise + end) / 2


def bisect(wanted, low, high):
    """Where `wanted` (increasing from low to high, elementwise) turns true."""
    low, high = np.array(low, float), np.array(high, float)
    for _ in range(70):
        middle = (low + high) / 2
        yes = wanted(middle)
        low, high = np.where(yes, low, middle), np.where(yes, middle, high)
    return high


def can_last(time, way, begin, end, limit, bound):
    """Tell whether an axis can cover the way in that time: ramp, cruise, ramp at full bound.

    The faster it cruises, the farther it gets; the fastest and the slowest cruise are those whose
    ramps just fit into the time.
    """

    def way_at(cruise):
        spent, covered = ramps(cruise, begin, end, bound)
        return covered + cruise * (time - spent), spent <= time

    low_end, high_end = np.minimum(begin, end), np.maximum(begin, end)
    fastest = bisect(lambda c: ~way_at(c)[1], high_end, limit + 1e-12)
    slowest = bisect(lambda c: way_at(c)[1], -limit - 1e-12, low_end)
    enough = time >= np.abs(end - begin) / bound
    return enough & (way_at(slowest)[0] <= way) & (way <= way_at(fastest)[0])


def least_time_twin(way, begin, end, limit, bound):
    """Least time of one axis: bisect the peak (or valley) of an up-and-down profile."""
    _, direct = ramps(end, begin, end, bound)
    forward = way >= direct
    top = np.where(forward, limit, -limit)
    start = np.where(forward, np.maximum(begin, end), np.minimum(begin, end))

    def peak_at(share):
        return start + share * (top - start)

    def far_enough(share):
        covered = ramps(peak_at(share), begin, end, bound)[1]
        return np.where(forward, covered >= way, covered <= way)

    # On the way from the slower end to rest the profile moves away from where it must get to.
    rest = np.where(start * top < 0, -start / np.where(top == start, 1, top - start), 0.0)
    peak = peak_at(bisect(far_enough, rest, np.ones_like(rest)))
    spent, covered = ramps(peak, begin, end, bound)
    return spent + np.where(far_enough(np.ones_like(rest)), 0.0, (way - covered) / top)


def random_connections(count, seed=0):
    """Ways, velocities at both ends and bounds of three axes each, in float64."""
    rng = np.random.default_rng(seed)
    limit = rng.uniform(0.05, 0.5, (count, 3))
    bound = rng.uniform(0.02, 0.5, (count, 3))
    begin, end = limit * rng.uniform(-1, 1, (2, count, 3))
    begin[::7], end[::5] = 0.0, 0.0
    way = rng.normal(size=(count, 3)) * rng.choice([0.02, 0.2, 3.0], (count, 1))
    return way, begin, end, limit, bound
