"""Laws of guide paths: cut and joined they stay the same, and a cut ends with its walk."""

from dataclasses import fields

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from jaxleas.types import GuidePath, cut_walks


def wandering(count: int, seed: int = 0) -> GuidePath:
    rng = np.random.default_rng(seed)
    position, velocity = rng.normal(size=(2, count, 3)).astype(np.float32)
    yaw = rng.uniform(-np.pi, np.pi, count).astype(np.float32)
    return GuidePath(np.arange(count) * 0.2, position, yaw, velocity, rng.random(count) < 0.9)


def assert_alike(left: GuidePath, right: GuidePath) -> None:
    np.testing.assert_allclose(left.time, right.time, atol=1e-9)
    for each in fields(GuidePath)[1:]:
        np.testing.assert_array_equal(getattr(left, each.name), getattr(right, each.name))


@given(st.integers(1, 40), st.data())
def test_a_path_cut_in_two_and_joined_is_the_path(count, data):
    path = wandering(count)
    at = data.draw(st.integers(0, count - 1))
    assert_alike(GuidePath.join([path[: at + 1], path[at:]]), path)


@given(st.integers(1, 40), st.data())
def test_length_is_additive(count, data):
    path = wandering(count)
    at = data.draw(st.integers(0, count - 1))
    assert path[: at + 1].length + path[at:].length == pytest.approx(path.length)
    assert path.distance[at] == pytest.approx(path[: at + 1].length)


def test_length_is_what_a_slow_twin_adds_up():
    path = wandering(30)
    steps = zip(path.position[:-1].tolist(), path.position[1:].tolist(), strict=True)
    slow = sum(sum((b - a) ** 2 for a, b in zip(*pair, strict=True)) ** 0.5 for pair in steps)
    assert path.length == pytest.approx(slow)


def test_the_clock_of_joined_paths_runs_on_from_zero():
    path = wandering(7)
    late = GuidePath(path.time + 5.0, path.position, path.yaw, path.velocity, path.valid)
    whole = GuidePath.join([late, late, late])
    np.testing.assert_allclose(whole.time, np.arange(19) * 0.2)
    assert len(GuidePath.join([late])) == 7


def test_configurations_are_chosen_by_slice_by_index_and_by_mask():
    path = wandering(9)
    every_second = np.arange(0, 9, 2)
    mask = np.isin(np.arange(9), every_second)
    for rows in (every_second, mask):
        assert_alike(path[rows], path[::2])
    assert len(path[:0]) == 0
    assert path[:0].length == 0.0


@given(st.integers(1, 12), st.integers(0, 2**16))
def test_a_cut_ends_where_its_walk_ends(walks, seed):
    rng = np.random.default_rng(seed)
    recorded = [wandering(20, seed + number) for number in range(walks)]
    counts = rng.integers(0, 21, walks)
    whole = GuidePath(
        *(np.stack([getattr(e, f.name) for e in recorded]) for f in fields(GuidePath))
    )
    for path, walk, count in zip(
        cut_walks(whole, whole.valid, counts, 0.2), recorded, counts, strict=True
    ):
        assert_alike(path, walk[:count])
