import re
from pathlib import Path

import jax.numpy as jnp
import numpy as np
import pytest

from jaxleas.conditions import VOID_IN_ROOT
from jaxleas.terrain.atlas import make_atlas
from jaxleas.terrain.height_map import HeightMap
from jaxleas.types import NO_GROUND, InputError, is_ground
from jaxleas.xla.huge_pages import hold_in_huge_pages


def random_map(seed, shape, origin, resolution=0.1):
    rng = np.random.default_rng(seed)
    heights = rng.uniform(-1, 1, shape).astype(np.float32)
    heights[rng.random(shape) < 0.1] = np.nan
    return HeightMap(heights, resolution, origin)


def test_sampling_equals_the_slow_twin_on_every_map():
    maps = [random_map(0, (31, 44), (-1.0, 2.0)), random_map(1, (50, 20), (3.0, -7.5))]
    atlas = make_atlas(maps)
    assert len(atlas) == 2
    rng = np.random.default_rng(2)
    for index, each in enumerate(maps):
        x_min, x_max, y_min, y_max = each.extent
        points = rng.uniform([x_min - 1, y_min - 1], [x_max + 1, y_max + 1], (4000, 2))
        cells = (points - np.array(each.origin)) / each.resolution
        inside_a_cell = np.all(np.abs(cells - np.floor(cells) - 0.5) > 1e-3, axis=1)
        points = points[inside_a_cell]
        expected = each.height_at(points)
        sampled = atlas.height_at(jnp.int32(index), jnp.asarray(points, jnp.float32))
        np.testing.assert_array_equal(sampled, np.where(np.isnan(expected), NO_GROUND, expected))


def test_ground_is_where_the_height_map_has_some_on_the_host_and_on_the_device():
    each = random_map(3, (12, 9), (0.0, 0.0))
    rows, columns = np.mgrid[0:12, 0:9]
    points = np.stack([columns, rows], axis=-1).reshape(-1, 2) * each.resolution
    on_device = make_atlas([each]).height_at(jnp.int32(0), jnp.asarray(points, jnp.float32))
    there = is_ground(each.height_at(points))
    assert 0 < there.sum() < len(there)
    np.testing.assert_array_equal(there, ~np.isnan(each.heights.ravel()))
    np.testing.assert_array_equal(is_ground(on_device), there)


def test_without_ground_a_condition_sees_less_than_its_bound_from_every_root():
    for z in (-1000.0, 0.0, 9000.0):
        assert NO_GROUND - z < VOID_IN_ROOT


def test_far_away_there_is_no_ground():
    atlas = make_atlas([random_map(0, (5, 5), (0.0, 0.0))])
    far = jnp.array([[1e6, 0.0], [-1e6, 3.0], [0.2, 1e9], [1e9, -1e9]])
    np.testing.assert_array_equal(atlas.height_at(jnp.int32(0), far), NO_GROUND)


def test_maps_of_different_resolution_are_refused():
    with pytest.raises(InputError, match="one resolution"):
        make_atlas([random_map(0, (5, 5), (0, 0)), random_map(0, (5, 5), (0, 0), 0.2)])


def test_an_empty_atlas_is_refused():
    with pytest.raises(InputError, match="at least one"):
        make_atlas([])


def test_a_large_array_keeps_its_numbers_in_large_pages():
    numbers = np.arange(2_000_000, dtype=np.float32)
    array = jnp.asarray(numbers)
    if not hold_in_huge_pages(array):
        pytest.skip("no large pages here")
    np.testing.assert_array_equal(array, numbers)
    address, size, large = array.unsafe_buffer_pointer(), 0, 0
    for line in Path("/proc/self/smaps").read_text().splitlines():
        if re.match(r"[0-9a-f]+-[0-9a-f]+ ", line):
            first, last = (int(each, 16) for each in line.split()[0].split("-"))
            size = last - first if first < address + array.nbytes and last > address else 0
        elif size and line.startswith("AnonHugePages"):
            large += int(line.split()[1])
    assert large >= 4096  # KiB, of 7812: the ends need not fill a page


def test_a_small_array_is_left_alone():
    assert not hold_in_huge_pages(jnp.zeros(10))
