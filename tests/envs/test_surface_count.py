"""The number of surfaces around the robot: a flood fill as its twin, and who sees it."""

import jax
import numpy as np
import pytest

from jaxleas.envs.steering import THESIS144, THESIS145
from jaxleas.envs.steering.surface_count import STEP, WINDOW, surface_count

from . import compiled
from .worlds import flat, height_map, standing, world_of

ROWS, COLUMNS = THESIS145.rows, THESIS145.columns
RANGE = (-1.4, -0.2)
VOID = -1e4
MOST = 72
"""Number of terrains that are counted at a time."""
COUNT = jax.jit(lambda heights: surface_count(heights, ROWS, COLUMNS, RANGE))


def count(heights):
    grids = np.atleast_2d(np.asarray(heights, np.float32))
    rows = np.resize(grids, (MOST, grids.shape[1]))  # one shape: compiled once
    return np.asarray(COUNT(rows))[: len(grids)].reshape(np.shape(heights)[:-1])


def flood_fill(heights) -> int:
    """Count what hangs together in the window, cell by cell."""
    grid = np.reshape(heights, (len(ROWS), len(COLUMNS)))
    inside = np.abs(ROWS)[:, None] <= WINDOW / 2, np.abs(COLUMNS)[None] <= WINDOW / 2
    left = {
        (int(row), int(column))
        for row, column in np.argwhere(inside[0] & inside[1])
        if RANGE[0] < grid[row, column] < RANGE[1]
    }
    pieces = 0
    while left:
        pieces += 1
        front = [left.pop()]
        while front:
            row, column = front.pop()
            for there in (
                (row + 1, column),
                (row - 1, column),
                (row, column + 1),
                (row, column - 1),
            ):
                if there in left and abs(grid[there] - grid[row, column]) <= STEP:
                    left.remove(there)
                    front.append(there)
    return pieces


def tiles(generator, low, high, cuts):
    """Cut a rectangle into rectangles, each of a height of its own or void: none holds another."""
    grid = np.zeros((len(ROWS), len(COLUMNS)))
    parts = [(0, len(ROWS), 0, len(COLUMNS))]
    for _ in range(cuts):
        top, bottom, left, right = parts.pop(int(generator.integers(len(parts))))
        if generator.random() < 0.5 and bottom - top > 1:
            middle = int(generator.integers(top + 1, bottom))
            parts += [(top, middle, left, right), (middle, bottom, left, right)]
        elif right - left > 1:
            middle = int(generator.integers(left + 1, right))
            parts += [(top, bottom, left, middle), (top, bottom, middle, right)]
        else:
            parts.append((top, bottom, left, right))
    levels = generator.permutation(np.linspace(low, high, len(parts)))
    for level, (top, bottom, left, right) in zip(levels, parts, strict=True):
        grid[top:bottom, left:right] = VOID if generator.random() < 0.2 else level
    return grid.ravel()


def test_it_equals_a_flood_fill_where_no_surface_lies_within_another():
    generator = np.random.default_rng(0)
    terrains = [tiles(generator, -1.3, -0.3, cuts) for cuts in range(12) for _ in range(6)]
    found = count(np.stack(terrains))
    np.testing.assert_array_equal(found, [flood_fill(each) for each in terrains])
    assert len(np.unique(found)) > 5


def test_a_ramp_is_one_surface_and_a_step_makes_two():
    x, _ = THESIS145.points_in_root.T
    ramp = -1.0 + 0.08 * x
    assert count(ramp) == 1
    assert count(ramp + 0.05 * (x > 0.1)) == 2
    assert count(np.where(x > 0.1, VOID, ramp)) == 1
    assert count(np.full_like(ramp, VOID)) == 0


def test_a_surface_within_another_is_not_counted():
    grid = np.full((len(ROWS), len(COLUMNS)), -1.0)
    grid[4, 6] = -0.9
    assert count(grid.ravel()) == flood_fill(grid.ravel()) - 1


def test_left_and_right_do_not_matter():
    generator = np.random.default_rng(1)
    terrains = np.stack([tiles(generator, -1.3, -0.3, 8) for _ in range(20)])
    mirrored = terrains[:, THESIS144.mirror_permutation[4:] - 4]
    np.testing.assert_array_equal(count(terrains), count(mirrored))


def test_the_policy_sees_it_after_the_heights():
    env = compiled.steering_env(observation="thesis145")
    plain = compiled.steering_env()
    world = world_of(height_map(lambda x, y: np.where(x > 0.2, 0.15, 0.0)), height_map(flat))
    motion = standing(env, [[0.0, 0.0], [0.0, 0.0]], 0.0)
    heights = compiled.local_heights(env, world.atlas, world.map_index, motion)
    goal = np.float32([[2.0, 1.0], [2.0, 1.0]])
    seen = np.asarray(compiled.observe(env, heights, motion, goal))
    assert seen.shape == (2, 145) == (2, env.layout.size)
    np.testing.assert_array_equal(seen[:, :144], compiled.observe(plain, heights, motion, goal))
    np.testing.assert_array_equal(seen[:, 144], [2.0, 1.0])


@pytest.mark.parametrize("layout", [THESIS145], ids=lambda layout: layout.name)
def test_mirroring_leaves_the_number_where_it_is(layout):
    assert layout.mirror_permutation[-1] == layout.size - 1
    assert layout.mirror_sign[-1] == 1.0
    assert sorted(layout.mirror_permutation) == list(range(layout.size))
