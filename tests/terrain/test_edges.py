"""Edges of height maps, against loops over cells that share no code with them."""

import jax.numpy as jnp
import numpy as np
import pytest

from jaxleas.terrain import EdgeSearch, HeightMap, edge_distances, find_edges
from jaxleas.terrain.edges import edge_cells
from jaxleas.types import NO_GROUND, InputError, is_ground

CELL = 0.02


def window(heights, row, column):
    rows, columns = heights.shape
    return np.array(
        [
            heights[min(max(row + i, 0), rows - 1), min(max(column + j, 0), columns - 1)]
            for i in (-1, 0, 1)
            for j in (-1, 0, 1)
        ]
    )


def each_cell(heights, answer):
    rows, columns = heights.shape
    return np.array([[answer(heights, r, c) for c in range(columns)] for r in range(rows)])


def twin(heights, search):
    """Return filtered heights, unsafe cells and distances, cell by cell."""

    def highest(heights, row, column):
        known = [each for each in window(heights, row, column) if not np.isnan(each)]
        return max(known) if known else np.nan

    def lowest(heights, row, column):
        values = window(heights, row, column)
        return np.nan if np.isnan(values).any() else values.min()

    def median(heights, row, column):
        known = sorted(each for each in window(heights, row, column) if not np.isnan(each))
        return np.nan if np.isnan(heights[row, column]) else known[(len(known) - 1) // 2]

    def is_unsafe(heights, row, column):
        near = window(heights, row, column)
        return bool(np.isnan(near).any() or max(near) - min(near) > search.rise)

    filtered = each_cell(each_cell(heights, highest), lowest) if search.closes else heights
    for _ in range(search.medians):
        filtered = each_cell(filtered, median)
    unsafe = each_cell(filtered, is_unsafe)
    rows, columns = heights.shape
    bad = [(r, c) for r in range(-1, rows + 1) for c in range(-1, columns + 1)]
    bad = np.array(
        [(r, c) for r, c in bad if not (0 <= r < rows and 0 <= c < columns) or unsafe[r, c]]
    )
    cells = np.moveaxis(np.indices(heights.shape), 0, -1).reshape(-1, 1, 2)
    distance = np.sqrt(((cells - bad[None]) ** 2).sum(-1).min(axis=1)).reshape(heights.shape)
    return filtered, unsafe, CELL * distance


def rough(seed, shape=(19, 26), holes=True):
    generator = np.random.default_rng(seed)
    steps = np.where(np.arange(shape[1]) > 11, 0.1, 0.0)[None] * np.ones(shape)
    heights = steps + generator.normal(size=shape) * 0.004
    if holes:
        heights[generator.random(shape) < 0.06] = np.nan
        heights[3:8, 15:21] = np.nan
    return heights.astype(np.float32)


@pytest.mark.parametrize(("medians", "closes"), [(0, True), (2, True), (0, False)])
def test_scipy_and_jax_agree_with_the_twin(medians, closes):
    search = EdgeSearch(rise=0.02, medians=medians, closes=closes)
    maps = [rough(0, holes=False), rough(1, holes=True)]
    batch = edge_distances(jnp.asarray(np.nan_to_num(maps, nan=NO_GROUND)), CELL, search)
    for index, heights in enumerate(maps):
        filtered, unsafe, distance = twin(heights.astype(float), search)
        found = find_edges(HeightMap(heights, CELL, (0.0, 0.0)), search)
        np.testing.assert_array_equal(found.filtered.heights, filtered.astype(np.float32))
        np.testing.assert_array_equal(found.unsafe, unsafe)
        np.testing.assert_allclose(found.distance, distance, atol=1e-12)
        in_jax = [np.asarray(each[index]) for each in batch]
        np.testing.assert_array_equal(np.where(is_ground(in_jax[0]), in_jax[0], np.nan), filtered)
        np.testing.assert_array_equal(in_jax[1], unsafe)
        np.testing.assert_allclose(in_jax[2], distance, rtol=1e-6)
        assert 0 < unsafe.mean() < 1


def test_a_step_is_an_edge_on_both_sides():
    heights = np.zeros((21, 31), np.float32)
    heights[:, 16:] = 0.05
    found = find_edges(HeightMap(heights, CELL, (0.0, 0.0)))
    assert np.flatnonzero(found.unsafe[10]).tolist() == [15, 16]
    np.testing.assert_allclose(found.distance[10, 8:15], CELL * np.arange(7, 0, -1), atol=1e-12)


def test_a_centimetre_of_noise_makes_no_edges():
    noise = np.random.default_rng(0).normal(size=(100, 100)) * 0.01
    assert edge_cells(noise, rise=0.02).mean() > 0.85
    noisy = HeightMap(noise.astype(np.float32), CELL, (0.0, 0.0))
    assert find_edges(noisy).unsafe.mean() < 0.002


def test_small_holes_close_and_large_ones_stay_unsafe():
    heights = np.zeros((30, 30), np.float32)
    heights[5, 5] = heights[5, 6] = np.nan
    heights[15:20, 15:20] = np.nan
    found = find_edges(HeightMap(heights, CELL, (0.0, 0.0)))
    assert not found.unsafe[5, 5:7].any()
    assert found.unsafe[14:21, 14:21].all()  # with the cells next to the hole
    assert found.unsafe.sum() == 49


def test_a_narrow_trench_is_an_edge_unless_it_is_closed():
    heights = np.zeros((12, 20), np.float32)
    heights[:, 9:11] = np.nan
    trench = HeightMap(heights, CELL, (0.0, 0.0))
    assert not find_edges(trench, EdgeSearch(medians=0)).unsafe.any()
    unsafe = find_edges(trench, EdgeSearch(medians=0, closes=False)).unsafe
    np.testing.assert_array_equal(np.flatnonzero(unsafe[5]), [8, 9, 10, 11])


def test_absurd_searches_are_refused():
    with pytest.raises(InputError, match="rise above 0 m"):
        EdgeSearch(rise=0.0)
    with pytest.raises(InputError, match="at least 0 medians"):
        EdgeSearch(medians=-1)
