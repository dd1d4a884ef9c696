import numpy as np
import pytest

from jaxleas.footsteps import FootCostMap, buffer_of, draw_cost_map
from jaxleas.footsteps.fitting import FitSettings, fit_motion_models
from jaxleas.terrain import HeightMap
from jaxleas.types import InputError
from tests.footsteps.made import walked

CELL = 0.02


@pytest.fixture
def ledge():
    """Ground up to x = 0.6 m, then none for 20 cells, then ground again."""
    heights = np.zeros((40, 80), np.float32)
    heights[:, 31:51] = np.nan
    return HeightMap(heights, CELL, (0.0, -0.4))


def test_the_buffer_is_what_is_unsafe_and_the_error():
    model = fit_motion_models(walked(20, 60, noise=0.003), FitSettings(network=False)).model
    assert buffer_of(model) == 0.015 + model.errors.landing["0.95"]
    assert 0.005 < model.errors.landing["0.95"] < 0.02


def test_feet_keep_the_buffer_from_holes_and_borders(ledge):
    costs = FootCostMap.of(ledge, buffer=0.05)
    columns = np.flatnonzero(costs.safe[20])
    # Distances are whole cells: 6 cm is the first above the buffer.
    assert columns.tolist() == [*range(2, 28), *range(54, 78)]
    assert costs.cost[20, 10] == 0.0
    assert costs.cost[20, 28] == pytest.approx(0.07 - 0.04)


def test_the_nearest_safe_cell_is_that_of_all(ledge):
    costs = FootCostMap.of(ledge, buffer=0.05)
    point = np.array([0.63, -0.05])
    found = costs.nearest_safe(point)
    safe = [(0.02 * c, -0.4 + 0.02 * r) for r, c in zip(*np.nonzero(costs.safe), strict=True)]
    assert tuple(found) == pytest.approx(min(safe, key=lambda each: np.hypot(*(each - point))))


def test_a_map_without_a_safe_cell_is_refused(ledge):
    with pytest.raises(InputError, match=r"no safe cell: its widest patch .* must keep 50.0 cm"):
        FootCostMap.of(ledge, buffer=0.5)


def test_the_picture_is_written(ledge, tmp_path):
    draw_cost_map(ledge, FootCostMap.of(ledge, buffer=0.05), tmp_path / "costs.png")
    assert (tmp_path / "costs.png").stat().st_size > 10_000
