"""What each value of a search does, and what is said of wrong ones."""

import numpy as np
import pytest

from jaxleas.terrain import Cell, PlaneSearch, find_surfaces, surfaces_in_words
from jaxleas.terrain.polygons import polygon_area_vector
from jaxleas.types import InputError
from tests.terrain.planes.conftest import CELL, map_of, noisy


def test_holes_up_to_a_width_are_closed_and_wider_ones_are_not():
    heights = np.zeros((60, 60))
    heights[10:13, 10:12] = np.nan  # 6 cm
    heights[30:40, 30:36] = np.nan  # 20 cm
    count = lambda **values: len(find_surfaces(map_of(heights), PlaneSearch(**values)).polygons)  # noqa: E731
    assert count(closing=0.25) == 1
    assert count(closing=0.0) > count() > 1
    heights[45, 20] = 0.05  # a lone cell that stands out
    assert count(closing=0.25) > 1


def test_surfaces_are_drawn_in_by_the_inset():
    heights = np.full((60, 80), np.nan)
    heights[10:40, 10:60] = 0.2
    for inset in (0.0, 0.01, 0.03, 0.1):
        (polygon,) = find_surfaces(map_of(heights), PlaneSearch(inset=inset)).polygons.values()
        area = float(polygon_area_vector(polygon)[2])
        assert area == pytest.approx((1.0 - 2 * inset) * (0.6 - 2 * inset), abs=1e-6)


def test_what_is_too_small_or_too_rough_is_left_over():
    heights = np.full((60, 60), np.nan)
    heights[5:13, 5:13] = 0.0  # 256 cm2
    heights[5:35, 20:50] = 0.0
    found = find_surfaces(map_of(heights), PlaneSearch(min_area=0.05))
    assert len(found.polygons) == 1
    assert (found.cells == Cell.SMALL).sum() == 64
    assert found.shares[Cell.VOID] == pytest.approx(1.0 - (64 + 900) / 3600)
    rough = noisy(map_of(np.zeros((50, 50))), 0, 0.04)
    assert find_surfaces(rough).shares[Cell.ROUGH] > 0.9
    assert len(find_surfaces(rough, PlaneSearch(roughness=0.06)).fit) == 1


def test_a_map_is_described_in_one_line():
    heights = np.zeros((40, 40))
    heights[:, :10] = np.nan
    line = surfaces_in_words(find_surfaces(map_of(heights)))
    assert line == (
        "1 surface, 0.45 m2, found in the map; their cells lie 0.0 mm off it (RMS); left over are"
        " 25.0 % of the cells: 25.0 % void"
    )


@pytest.mark.parametrize(
    ("value", "message"),
    [
        ({"max_slope": 70.0}, "--max-slope 70 must be from 0 to 60"),
        ({"min_area": -1.0}, "--min-area -1 must be from 0"),
        ({"inset": float("nan")}, "--inset nan must be from 0 to 1"),
        ({"noise": 3.0}, "--noise 3 must be from 0 to 1"),
    ],
)
def test_numbers_out_of_range_are_refused(value, message):
    with pytest.raises(InputError, match=message):
        PlaneSearch(**value)


def test_coarse_fine_and_tiny_maps_are_read():
    assert len(find_surfaces(map_of(np.zeros((4, 4)), 0.5)).polygons) == 1
    assert len(find_surfaces(map_of(np.zeros((9, 9)), 0.1)).polygons) == 1
    assert len(find_surfaces(map_of(np.zeros((120, 120)), 0.005)).polygons) == 1
    assert CELL == 0.02
