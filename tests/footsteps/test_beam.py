"""The states that a beam keeps: the best of each stratum before the second best of any."""

import numpy as np

from jaxleas.footsteps.beam import key_of, place_in_group


def test_places_in_groups_are_those_of_counting():
    rng = np.random.default_rng(3)
    for count in (1, 2, 50, 400):
        parts = rng.integers(-5, 5, count), rng.integers(-3, 3, count).astype(float)
        seen: dict[tuple[int, int], int] = {}
        wanted = []
        for pair in zip(*(part.astype(int).tolist() for part in parts), strict=True):
            wanted.append(seen.get(pair, 0))
            seen[pair] = wanted[-1] + 1
        np.testing.assert_array_equal(place_in_group(key_of(parts)), wanted)


def test_keys_differ_where_a_part_does():
    grid = np.stack(np.meshgrid(np.arange(-4, 5), np.arange(3), np.arange(-2, 0)), -1)
    parts = grid.reshape(-1, 3).T
    assert len(np.unique(key_of(tuple(parts)))) == parts.shape[1]
