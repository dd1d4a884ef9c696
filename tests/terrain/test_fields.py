"""Fields: sections on which a quadruped places its feet."""

from typing import Any

import numpy as np
import pytest
from pydantic import ValidationError

from jaxleas.terrain import FIELD_KINDS, FieldConfig, draw_field

CONFIG = FieldConfig()
SEEDS = range(6)
EVERY_KIND = pytest.mark.parametrize("kind", FIELD_KINDS)


def runs(values: np.ndarray) -> list[tuple[float, int]]:
    """Return each value of a row that is repeated, with the number of its repetitions."""
    same = np.append(values[1:] != values[:-1], True)
    ends = np.flatnonzero(same & ~(np.isnan(values) & np.append(np.isnan(values[1:]), False)))
    return list(zip(values[ends].tolist(), np.diff(ends, prepend=-1).tolist(), strict=True))


@EVERY_KIND
def test_a_seed_says_all(kind):
    first, again, other = (draw_field(kind, CONFIG, seed).heights for seed in (3, 3, 4))
    np.testing.assert_array_equal(first, again)
    assert kind == "flat" or not np.array_equal(first, other, equal_nan=True)


@EVERY_KIND
def test_it_fills_its_size(kind):
    config = FieldConfig(length=6.0, width=3.0, resolution=0.04)
    field = draw_field(kind, config, 0)
    assert field.shape == (75, 150)
    assert field.extent == pytest.approx((0.0, 6.0, 0.0, 3.0))


def test_flat_is_level():
    assert (draw_field("flat", CONFIG, 1).heights == 0.0).all()


@pytest.mark.parametrize("seed", SEEDS)
def test_gaps_are_as_wide_as_asked_and_the_rest_is_level(seed):
    heights = draw_field("gaps", CONFIG, seed).heights
    assert (np.isnan(heights) == np.isnan(heights[0])).all()
    assert np.nanmax(np.abs(heights)) == 0.0
    widths = [count * CONFIG.resolution for value, count in runs(heights[0]) if np.isnan(value)]
    assert widths
    low, high = CONFIG.gap
    assert all(low - 0.01 <= width <= high + 0.01 for width in widths)


@pytest.mark.parametrize("seed", SEEDS)
def test_stairs_rise_by_risers_after_treads(seed):
    row = draw_field("stairs", CONFIG, seed).heights[0]
    levels = runs(row)
    rises = np.abs(np.diff([height for height, _ in levels]))
    assert len(rises) >= 2
    low, high = CONFIG.riser
    assert ((rises > low - 1e-6) & (rises < high + 1e-6)).all()
    treads = [count * CONFIG.resolution for _, count in levels[1:-1]]
    assert min(treads) > CONFIG.tread[0] - 0.01


@pytest.mark.parametrize("seed", SEEDS)
def test_stones_are_squares_apart_from_each_other(seed):
    from scipy import ndimage

    heights = draw_field("stones", CONFIG, seed).heights
    found: Any = ndimage.label(~np.isnan(heights))
    labels, count = found
    boxes = ndimage.find_objects(labels)
    inner = [
        box
        for box in boxes
        if box[0].start > 0 and box[0].stop < heights.shape[0] and box[1].stop < heights.shape[1]
    ]
    assert count > 20
    low, high = CONFIG.stone
    for rows, columns in inner:
        sides = [CONFIG.resolution * (each.stop - each.start) for each in (rows, columns)]
        assert sides[0] == pytest.approx(sides[1])
        assert low - 0.01 <= sides[0] <= high + 0.01
        assert np.ptp(heights[rows, columns]) == 0.0
    assert np.nanmax(np.abs(heights)) <= CONFIG.stone_rise


@pytest.mark.parametrize("seed", SEEDS)
def test_neighbouring_plates_differ_by_what_is_asked(seed):
    heights = draw_field("random_stairs", CONFIG, seed).heights
    assert np.isfinite(heights).all()
    most = CONFIG.plate_slope + 2.0 * CONFIG.plate_rise + 1e-6
    assert max(np.abs(np.diff(heights, axis=axis)).max() for axis in (0, 1)) <= most
    # The slope runs along a diagonal: opposite corners differ by about its length.
    corners = heights[[0, 0, -1, -1], [0, -1, 0, -1]]
    assert np.ptp(corners) > CONFIG.plate_slope * 6


def test_a_temple_has_gaps_stones_and_steps_somewhere():
    fields = [draw_field("temple", CONFIG, seed).heights for seed in range(12)]
    is_gap = [np.isnan(field).all(axis=0).any() for field in fields]
    is_stepped = [abs(field[0, 0] - field[0, -1]) > 0.04 for field in fields]
    assert any(is_gap)
    assert any(is_stepped)


def test_a_range_upside_down_is_refused():
    with pytest.raises(ValidationError, match=r"gap = \[0\.3, 0\.1\] must be"):
        FieldConfig(gap=(0.3, 0.1))
