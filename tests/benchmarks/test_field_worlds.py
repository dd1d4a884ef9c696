"""Fields as boxes: each cell with ground is covered once, at its height."""

import numpy as np
import pytest

from benchmarks.field_worlds import level_rectangles, place_of, world_of
from jaxleas.terrain import FieldConfig, draw_field, ground_height

SMALL = FieldConfig(length=3.0, width=2.0, resolution=0.04)


@pytest.mark.parametrize("kind", ["flat", "gaps", "stones", "stairs", "random_stairs"])
def test_rectangles_cover_each_cell_once(kind):
    field = draw_field(kind, SMALL, 3)
    counts, heights = np.zeros(field.shape), np.full(field.shape, np.nan)
    rows, columns = np.indices(field.shape)
    x, y = (field.origin[0] + 0.04 * columns, field.origin[1] + 0.04 * rows)
    for corners in level_rectangles(field):
        low, high = corners.min(axis=0), corners.max(axis=0)
        inside = (x > low[0]) & (x < high[0]) & (y > low[1]) & (y < high[1])
        counts += inside
        heights[inside] = low[2]
    np.testing.assert_array_equal(counts, np.isfinite(field.heights))
    np.testing.assert_array_equal(heights, field.heights)


def test_fields_lie_side_by_side():
    fields = {number: draw_field("stairs", SMALL, number) for number in (0, 2)}
    scene = world_of(fields)
    for number, field in fields.items():
        middle = np.array([[1.49, 1.01]])
        found = ground_height(scene, middle + place_of(number)[:2])
        np.testing.assert_allclose(found, field.height_at(middle), atol=1e-9)
