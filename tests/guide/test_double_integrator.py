"""Minimum-time connections against a twin that only integrates velocity profiles and bisects."""

from dataclasses import fields

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from jaxleas.guide.double_integrator import axis_times, connect

COUNT = 10_000
TIMES_TO = 1e-6  # [s]


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


@pytest.fixture(scope="module")
def random_pairs():
    """Ways, velocities at both ends and bounds of three axes each, in float64."""
    rng = np.random.default_rng(0)
    limit = rng.uniform(0.05, 0.5, (COUNT, 3))
    bound = rng.uniform(0.02, 0.5, (COUNT, 3))
    begin, end = limit * rng.uniform(-1, 1, (2, COUNT, 3))
    begin[::7], end[::5] = 0.0, 0.0
    way = rng.normal(size=(COUNT, 3)) * rng.choice([0.02, 0.2, 3.0], (COUNT, 1))
    return way, begin, end, limit, bound


@pytest.fixture(scope="module")
def connected(random_pairs):
    with jax.enable_x64(True):
        arrays = [jnp.asarray(each) for each in random_pairs]
        times = [np.asarray(each) for each in jax.jit(axis_times)(*arrays)]
        found = jax.jit(connect)(*arrays)
        sampled = []
        for share in np.linspace(0, 1, 41):
            sampled.append(jax.tree.map(np.asarray, found.at(share * found.duration)))
        ways, velocities = (np.stack(each) for each in zip(*sampled, strict=True))
        host = {field.name: np.asarray(getattr(found, field.name)) for field in fields(found)}
    return times, host, ways, velocities


def test_each_axis_takes_the_least_time(random_pairs, connected):
    (least, _, _), *_ = connected
    np.testing.assert_allclose(least, least_time_twin(*random_pairs), atol=TIMES_TO, rtol=0)


def test_the_gap_is_where_the_axis_cannot_arrive(random_pairs, connected):
    (least, begin, end), *_ = connected
    gap = end > begin
    assert 500 < gap.sum() < 25_000  # both kinds are met
    assert np.all(begin[gap] >= least[gap] - 1e-9)
    assert np.all(can_last(least + TIMES_TO, *random_pairs)[~gap])
    for time, possible in (
        (begin - TIMES_TO, True),
        (begin + TIMES_TO, False),
        ((begin + end) / 2, False),
        (end - TIMES_TO, False),
        (end + TIMES_TO, True),
        (end + 50.0, True),
    ):
        clear = gap & (end - begin > 1e-4) & (begin - least > 1e-4)
        assert np.all(can_last(time, *random_pairs)[clear] == possible)
    for later in (0.1, 1.0, 10.0):
        assert np.all(can_last(least + later, *random_pairs)[~gap])
    assert not np.any(can_last(least - TIMES_TO, *random_pairs))


def test_together_they_take_the_least_time_that_all_can(random_pairs, connected):
    (least, begin, end), found, *_ = connected
    duration = found["duration"][:, None]
    assert np.all(can_last(duration + TIMES_TO, *random_pairs) | (np.abs(duration - begin) < 1e-5))
    # No earlier time will do: one axis would be too slow, or in its gap, all the way down.
    candidates = np.concatenate([least, end], axis=1)
    earlier = np.where(candidates < duration - TIMES_TO, candidates + 1e-9, -1.0)
    for column in earlier.T:
        assert not np.any(np.all(can_last(column[:, None], *random_pairs), axis=1))
    assert np.any(duration > least.max(axis=1, keepdims=True) + 1e-3)  # some wait for a gap's end


def test_it_begins_and_ends_as_asked_within_the_bounds(random_pairs, connected):
    _, found, ways, velocities = connected
    way, begin, end, limit, bound = random_pairs
    np.testing.assert_allclose(ways[0], 0.0, atol=1e-9)
    np.testing.assert_allclose(ways[-1], way, atol=1e-9)
    np.testing.assert_allclose(velocities[0], begin, atol=1e-9)
    np.testing.assert_allclose(velocities[-1], end, atol=1e-9)
    assert np.all(np.abs(velocities) <= limit + 1e-9)
    assert np.all(np.abs(found["acceleration"]) <= bound * (1 + 1e-6) + 1e-9)
    step = found["duration"] / 40
    changed = np.abs(np.diff(velocities, axis=0)) / step[:, None]
    assert np.all(changed <= bound * (1 + 1e-6) + 1e-6)
    # The way is the velocity's integral (piecewise linear: the trapezium errs at two kinks only).
    moved, mean = np.diff(ways, axis=0), (velocities[1:] + velocities[:-1]) / 2
    kink = 0.5 * np.abs(found["acceleration"]) * step[:, None] ** 2
    assert np.all(np.abs(moved - mean * step[:, None]) <= kink + 1e-9)


def test_known_answers():
    """1 m from rest to rest: 2 sqrt(d / A) unbounded, d / V + V / A at a bounded speed."""
    for limit, expected in ((10.0, 2.0 * np.sqrt(1.0 / 0.5)), (0.25, 1.0 / 0.25 + 0.25 / 0.5)):
        ones = jnp.ones(1)
        found = connect(ones, 0 * ones, 0 * ones, limit * ones, 0.5 * ones)
        np.testing.assert_allclose(found.duration, expected, rtol=1e-6)
    nothing = connect(*(jnp.zeros(3),) * 3, jnp.ones(3), jnp.ones(3))
    assert float(nothing.duration) == 0.0
    assert not np.any(nothing.at(jnp.float32(0.3))[0])
