"""Laws of the surfaces found in height maps: planes, edges, noise, turned and mirrored maps."""

from dataclasses import replace

import numpy as np
import pytest

from jaxleas.terrain import Cell, PlaneSearch, find_surfaces
from jaxleas.terrain.polygons import (
    convexity_deviation,
    planarity_deviation,
    polygon_area_vector,
)
from tests.terrain.planes.conftest import CELL, map_of, noisy, places, stairs

HALF = 0.5 * CELL


def plan_area(found) -> float:
    return sum(float(polygon_area_vector(each)[2]) for each in found.polygons.values())


@pytest.mark.parametrize("slope", [0.0, 0.1, 0.5, 0.99])
@pytest.mark.parametrize("angle", [0.0, 0.7, 2.4])
def test_a_plane_of_any_slope_is_found_exactly(slope, angle):
    x, y = places(40, 60)
    heights = 0.3 + slope * (np.cos(angle) * x + np.sin(angle) * y)
    found = find_surfaces(map_of(heights))
    (polygon,) = found.polygons.values()
    wanted = 0.3 + slope * (np.cos(angle) * polygon[:, 0] + np.sin(angle) * polygon[:, 1])
    np.testing.assert_allclose(polygon[:, 2], wanted, atol=1e-6)
    corners = {(HALF, HALF), (1.2 - HALF, HALF), (1.2 - HALF, 0.8 - HALF), (HALF, 0.8 - HALF)}
    assert {tuple(np.round(corner, 6)) for corner in polygon[:, :2].tolist()} == corners
    assert found.fit == pytest.approx([0.0], abs=1e-6)
    assert found.shares[Cell.SURFACE] == 1.0


def test_a_plane_steeper_than_allowed_is_left_over_and_why():
    x, _ = places(40, 60)
    found = find_surfaces(map_of(1.2 * x))  # 50 degrees
    assert not found.polygons
    assert found.shares[Cell.STEEP] == 1.0
    assert len(find_surfaces(map_of(1.2 * x), PlaneSearch(max_slope=55.0)).polygons) == 1


@pytest.mark.parametrize("angle", [0.0, 0.35])
@pytest.mark.parametrize("deviation", [0.0, 0.01])
def test_a_ridge_is_two_surfaces(angle, deviation):
    x, y = places(60, 80)
    across = np.cos(angle) * (x - 0.8) + np.sin(angle) * (y - 0.6)
    found = find_surfaces(noisy(map_of(-0.4 * np.abs(across)), 1, deviation))
    assert len(found.fit) == 2
    middles = [polygon.mean(axis=0) - [0.8, 0.6, 0.0] for polygon in found.polygons.values()]
    sides = [np.sign(np.cos(angle) * x + np.sin(angle) * y) for x, y, _ in middles]
    assert {-1.0, 1.0} == set(sides)
    assert found.shares[Cell.SURFACE] > 0.97


@pytest.mark.parametrize("angle", [0.0, 0.5, np.pi / 4])
def test_stairs_give_their_treads(angle, polygon_samples):
    height_map, rise, treads = stairs(angle)
    found = find_surfaces(height_map)
    assert len(found.fit) == len(treads)
    assert plan_area(found) > 0.85 * 2.4 * 1.2  # half a cell around each is left out
    check_treads(found, treads, angle, polygon_samples, over=CELL, off=1e-4)
    assert rise == 0.12


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("angle", [0.0, 0.5])
def test_noise_of_a_centimetre_leaves_the_treads(seed, angle, polygon_samples):
    height_map, _, treads = stairs(angle)
    found = find_surfaces(noisy(height_map, seed))
    assert len(found.fit) == len(treads)
    assert found.noise == pytest.approx(0.01, rel=0.1)
    exact = find_surfaces(height_map, PlaneSearch(inset=found.inset))
    assert plan_area(found) > 0.95 * plan_area(exact)
    check_treads(found, treads, angle, polygon_samples, over=0.0, off=0.005)


def check_treads(found, treads, angle, polygon_samples, over, off):
    """No polygon reaches beyond the edges of its tread by more than `over`, or is `off` it."""
    for name, polygon in found.polygons.items():
        begin, end, height = min(treads, key=lambda each: abs(each[2] - polygon[:, 2].mean()))
        x, y = polygon[:, 0] - 1.2, polygon[:, 1] - 0.6
        along = np.cos(angle) * x + np.sin(angle) * y + 1.2
        assert begin - along.min() < over, name
        assert along.max() - end < over, name
        assert np.abs(polygon_samples(polygon)[:, 2] - height).max() < off, name


@pytest.mark.parametrize("deviation", [0.0, 0.01])
def test_turned_mirrored_and_moved_maps_have_the_same_surfaces(deviation):
    height_map = noisy(stairs(0.3)[0], 5, deviation)
    plain = find_surfaces(height_map)
    heights = height_map.heights
    for other in (np.rot90(heights), heights[::-1], heights[:, ::-1], heights.T, heights + 7.0):
        found = find_surfaces(map_of(np.ascontiguousarray(other)))
        assert len(found.fit) == len(plain.fit)
        assert plan_area(found) == pytest.approx(plan_area(plain), rel=0.01)
    moved = find_surfaces(replace(height_map, origin=(-50.0, 31.0)))
    shift = np.array([-50.0 - HALF, 31.0 - HALF, 0.0])
    for name, polygon in plain.polygons.items():
        np.testing.assert_allclose(moved.polygons[name], polygon + shift, atol=1e-9)


def stepping_stones() -> tuple[np.ndarray, int]:
    """Return 6 x 8 stones of 0.2 m, 0.1 m apart, of random heights, and their number."""
    heights = np.full((100, 130), np.nan)
    levels = np.random.default_rng(2).uniform(0.0, 0.2, (6, 8))
    for row in range(6):
        for column in range(8):
            at = 6 + 15 * row, 6 + 15 * column
            heights[at[0] : at[0] + 10, at[1] : at[1] + 10] = levels[row, column]
    return heights, 48


@pytest.mark.parametrize("deviation", [0.0, 0.01])
@pytest.mark.parametrize("around", [np.nan, -0.4])
def test_stepping_stones_are_counted(deviation, around):
    heights, count = stepping_stones()
    ground = np.where(np.isnan(heights), around, heights)
    found = find_surfaces(noisy(map_of(ground), 3, deviation))
    stones = [p for p in found.polygons.values() if p[:, 2].min() > -0.3]
    assert len(stones) == count
    assert found.inset == pytest.approx(HALF + 3.0 * deviation, abs=5e-3)
    wanted = (10 * CELL - 2 * found.inset) ** 2
    areas = [float(polygon_area_vector(each)[2]) for each in stones]
    assert np.median(areas) == pytest.approx(wanted, rel=0.05)
    assert min(areas) > 0.8 * wanted
    assert max(areas) < 1.15 * wanted


@pytest.mark.parametrize("deviation", [0.0, 0.01])
def test_round_and_broken_ground_yields_no_nonsense(deviation, polygon_samples):
    x, y = places(80, 80)
    ball = np.sqrt(np.maximum(0.6**2 - (x - 0.8) ** 2 - (y - 0.8) ** 2, 0.0))
    blocks = np.kron(np.random.default_rng(4).uniform(0.0, 0.5, (40, 40)), np.ones((2, 2)))
    for heights in (ball, blocks):
        height_map = map_of(heights)
        found = find_surfaces(noisy(height_map, 6, deviation))
        for polygon in found.polygons.values():
            points = polygon_samples(polygon)
            off = np.abs(height_map.height_at(points[:, :2]) - points[:, 2])
            assert np.sqrt((off**2).mean()) < 0.02
    assert not found.polygons  # blocks of 4 cm are no ground for feet


def overlap(one: np.ndarray, other: np.ndarray, polygon_samples) -> float:
    """Return the area of points of one polygon that lie in another [m^2]."""
    points = polygon_samples(one)[:, :2]
    edge = np.roll(other, -1, axis=0)[:, :2] - other[:, :2]
    rest = points[:, None] - other[:, :2]
    inside = edge[:, 0] * rest[..., 1] - edge[:, 1] * rest[..., 0] > 0.002 * np.hypot(*edge.T)
    return 1e-4 * float(inside.all(axis=1).sum())


@pytest.mark.parametrize("deviation", [0.0, 0.01])
def test_polygons_are_convex_planar_and_apart(deviation, polygon_samples):
    x, y = places(100, 100)
    heights = np.where((x - 1.0) ** 2 + (y - 0.9) ** 2 < 0.3**2, np.nan, 0.1 * (x > 0.6))
    heights = np.where(y > 1.5 + 0.1 * x, 0.3 + 0.2 * y, heights)
    found = find_surfaces(noisy(map_of(heights), 7, deviation))
    polygons = list(found.polygons.values())
    assert len(found.fit) == 3
    for index, polygon in enumerate(polygons):
        assert planarity_deviation(polygon) < 1e-9
        assert convexity_deviation(polygon) < 1e-4
        assert polygon_area_vector(polygon)[2] > 0.0
        for other in polygons[index + 1 :]:
            assert overlap(polygon, other, polygon_samples) < 1e-3
        hole = np.hypot(*(polygon_samples(polygon)[:, :2] - [1.0, 0.9]).T)
        assert hole.min() > 0.3 - CELL
