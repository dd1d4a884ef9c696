"""Minimum-time connections against a twin that only integrates velocity profiles and bisects."""

from dataclasses import fields

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from jaxleas.guide.double_integrator import axis_times, connect
from tests.guide.integrator_twin import can_last, least_time_twin, random_connections

COUNT = 10_000
TIMES_TO = 1e-6  # [s]


@pytest.fixture(scope="module")
def random_pairs():
    return random_connections(COUNT)


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
