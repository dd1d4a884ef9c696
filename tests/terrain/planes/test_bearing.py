"""Corners of found surfaces: the heights under them bear them."""

import numpy as np
import pytest

from jaxleas.terrain import HeightMap, find_surfaces
from jaxleas.terrain.planes.bearing import are_borne, without_corners_in_the_air
from tests.terrain.planes.conftest import map_of

SQUARE = np.array([[0.1, 0.1, 0.0], [0.9, 0.1, 0.0], [0.9, 0.9, 0.0], [0.1, 0.9, 0.0]])
UP = np.tile([0.0, 0.0, 1.0], (4, 1))


def ground(heights=None) -> HeightMap:
    heights = np.zeros((50, 50)) if heights is None else heights
    return HeightMap(heights.astype(np.float32), 0.02, (0.01, 0.01))


def twin(points, plane, height_map, noise):
    """Judge points one by one: the bilinear height against the plane z = a x + b y + c."""
    found = []
    for x, y, _ in points:
        column, row = (np.array([x, y]) - height_map.origin) / height_map.resolution
        gap = squares = 0.0
        for r in (int(np.floor(row)), int(np.floor(row)) + 1):
            for c in (int(np.floor(column)), int(np.floor(column)) + 1):
                weight = (1.0 - abs(row - r)) * (1.0 - abs(column - c))
                height = height_map.heights[r, c]
                if np.isfinite(height):
                    place = (
                        height_map.origin[0] + c * height_map.resolution,
                        height_map.origin[1] + r * height_map.resolution,
                    )
                    gap += weight * (height - plane @ np.array([*place, 1.0]))
                    squares += weight**2
        found.append(abs(gap) <= 2.0 * noise * np.sqrt(squares))
    return np.array(found)


def test_the_twin_agrees_on_tilted_planes_with_holes():
    draw = np.random.default_rng(0)
    plane = np.array([0.3, -0.2, 0.1])
    heights = draw.normal(0.0, 0.01, (50, 50)) + 0.3 * 0.02 * np.arange(50) + 0.1
    heights -= 0.2 * 0.02 * np.arange(50)[:, None]
    heights[draw.random((50, 50)) < 0.3] = np.nan
    xy = draw.uniform(0.05, 0.9, (400, 2))
    points = np.column_stack([xy, xy @ plane[:2] + plane[2]])
    normals = np.tile([-0.6, 0.4, 2.0], (400, 1))
    borne = are_borne(points, normals, ground(heights), 0.01)
    np.testing.assert_array_equal(borne, twin(points, plane, ground(heights), 0.01))
    assert 0.5 < borne.mean() < 1.0


def test_what_is_borne_stays_as_it_is():
    (same,) = without_corners_in_the_air([SQUARE], ground(), 0.01)
    np.testing.assert_array_equal(same, SQUARE)
    assert without_corners_in_the_air([], ground(), 0.01) == []


def test_a_corner_over_a_step_is_cut_off_where_the_ground_begins():
    heights = np.zeros((50, 50))
    row, column = np.mgrid[:50, :50]
    heights[row + column > 84] = -0.1  # the corner at (0.9, 0.9) hangs in the air
    (cut,) = without_corners_in_the_air([SQUARE], ground(heights), 0.01)
    assert len(cut) == 5
    assert are_borne(cut, np.tile(UP[0], (5, 1)), ground(heights), 0.01).all()
    kept = SQUARE[:3]
    np.testing.assert_array_equal(cut[:2], kept[:2])
    assert cut[:, :2].sum(axis=1).max() < 85.5 * 0.02


def test_cuts_that_meet_leave_a_polygon():
    heights = np.full((50, 50), -1.0)
    (cut,) = without_corners_in_the_air([0.1 * SQUARE], ground(heights), 0.01)
    assert len(cut) == 4  # a corner in the middle of each side: no more can be known
    assert without_corners_in_the_air([SQUARE], ground(np.full((50, 50), np.nan)), 0.01)


@pytest.mark.parametrize("seed", range(2))
def test_crossing_planes_in_noise_give_corners_near_the_ground(seed):
    """Stones tilted against each other: the worst corner lies within 2 cm of one of them."""
    row, column = np.mgrid[:60, :60] * 0.02
    one, other = 0.2 * column - 0.1 * row, 0.24 - 0.2 * column + 0.05 * row
    exact = np.maximum(one, other)
    noise = 0.01 * np.random.default_rng(seed).normal(size=exact.shape)
    found = find_surfaces(map_of(exact + noise))
    corners = np.concatenate(list(found.polygons.values()))
    x, y = corners[:, 0] - 0.01, corners[:, 1] - 0.01
    planes = np.stack([0.2 * x - 0.1 * y, 0.24 - 0.2 * x + 0.05 * y])
    assert len(found.fit) == 2
    assert np.abs(corners[:, 2] - planes.max(axis=0)).max() < 0.02
