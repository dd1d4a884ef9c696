"""Seeds of planes."""

import numpy as np

from jaxleas.terrain.planes.seeds import flattest_first, large
from jaxleas.terrain.planes.windows import fit_windows


def test_seeds_come_by_their_flatness_and_not_once_taken_out():
    heights = np.random.default_rng(0).normal(size=(60, 50))
    windows = fit_windows(heights, np.ones(heights.shape, bool), 5)
    seeds = windows.deviation < np.nanmedian(windows.deviation)
    assert seeds.sum() > 1000  # more than are looked at together
    wanted = sorted(np.argwhere(seeds).tolist(), key=lambda at: windows.deviation[tuple(at)])
    found = []
    for row, column in flattest_first(seeds, windows):
        found.append([row, column])
        seeds[:, column] = False
    columns: set[int] = set()
    assert found == [at for at in wanted if not (at[1] in columns or columns.add(at[1]))]


def test_sets_of_too_few_cells_are_none():
    cells = np.zeros((6, 6), bool)
    cells[0, :3] = cells[3:5, 3:5] = cells[2, 2] = True
    kept = large(cells, 3)
    cells[2, 2] = False
    np.testing.assert_array_equal(kept, cells)
