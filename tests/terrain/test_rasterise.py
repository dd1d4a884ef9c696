import numpy as np
import pytest

from jaxleas.terrain import GeneratorConfig, Scene, TileKind, generate_arena, rasterise
from jaxleas.terrain.cells import BLOCK, padded_groups
from jaxleas.terrain.config import BridgeConfig
from jaxleas.terrain.rasterise import CLOSING, rasterise_polygons
from jaxleas.types import InputError

RESOLUTION = 0.05


def square(height: float = 0.0, size: float = 1.0) -> list[list[float]]:
    corners = ((0.0, 0.0), (size, 0.0), (size, size), (0.0, size))
    return [[x, y, height] for x, y in corners]


def slow_height(scene: Scene, x: float, y: float, grow: float) -> float:
    """Look at one point and one polygon at a time; no code shared with the rasteriser."""
    highest = float("nan")
    for polygon in [*scene.surfaces.values(), *scene.obstacles.values()]:
        low, high = polygon[:, :2].min(axis=0) - grow, polygon[:, :2].max(axis=0) + grow
        inside = bool(low[0] <= x <= high[0] and low[1] <= y <= high[1])
        for (ax, ay, _), (bx, by, _) in zip(polygon, np.roll(polygon, -1, axis=0), strict=True):
            left_of_edge = ((bx - ax) * (y - ay) - (by - ay) * (x - ax)) / np.hypot(
                bx - ax, by - ay
            )
            inside = inside and left_of_edge >= -grow
        if inside:
            normal = np.cross(polygon[1] - polygon[0], polygon[2] - polygon[0])
            height = polygon[0, 2] - (normal[:2] @ ([x, y] - polygon[0, :2])) / normal[2]
            highest = height if not highest > height else highest
    return highest


@pytest.mark.parametrize("seed", range(4))
def test_every_cell_agrees_with_the_slow_twin(seed, random_scene):
    scene, resolution = random_scene(seed), 0.09
    height_map = rasterise(scene, resolution, margin=0.2)
    rows, columns = height_map.shape
    expected = np.array(
        [
            [
                slow_height(
                    scene,
                    height_map.origin[0] + column * resolution,
                    height_map.origin[1] + row * resolution,
                    CLOSING,
                )
                for column in range(columns)
            ]
            for row in range(rows)
        ]
    )
    assert 0.05 < np.isnan(expected).mean() < 0.95
    np.testing.assert_array_equal(np.isnan(height_map.heights), np.isnan(expected))
    np.testing.assert_allclose(height_map.heights, expected, atol=2e-6)


def mirrored(polygon: np.ndarray) -> np.ndarray:
    return (polygon * np.array([-1.0, 1.0, 1.0]))[::-1]


@pytest.mark.parametrize("seed", range(5))
def test_a_mirrored_scene_gives_the_mirrored_map(seed, random_scene):
    scene = random_scene(seed)
    flipped = Scene({name: mirrored(polygon) for name, polygon in scene.surfaces.items()})
    original = rasterise(Scene(scene.surfaces), RESOLUTION)
    np.testing.assert_allclose(
        rasterise(flipped, RESOLUTION).heights, original.heights[:, ::-1], atol=2e-6
    )


@pytest.mark.parametrize("seed", range(5))
def test_shifting_by_whole_cells_shifts_the_map(seed, random_scene):
    scene = random_scene(seed)
    shift = np.array([13 * RESOLUTION, -7 * RESOLUTION, 0.5])
    moved = Scene({name: polygon + shift for name, polygon in scene.surfaces.items()})
    before, after = rasterise(Scene(scene.surfaces), RESOLUTION), rasterise(moved, RESOLUTION)
    np.testing.assert_allclose(after.heights, before.heights + 0.5, atol=2e-6)
    np.testing.assert_allclose(np.array(after.origin) - before.origin, shift[:2], atol=1e-9)


@pytest.mark.parametrize("seed", range(5))
def test_another_polygon_never_lowers_the_ground(seed, random_scene):
    scene = random_scene(seed)
    frame = {"frame": np.array([[-3.0, -3, -9], [3, -3, -9], [3, 3, -9], [-3, 3, -9]])}
    without = rasterise(Scene(frame | scene.surfaces), RESOLUTION)
    both = rasterise(Scene(frame | scene.surfaces, scene.obstacles), RESOLUTION)
    assert without.shape == both.shape
    ground = ~np.isnan(without.heights)
    assert (both.heights[ground] >= without.heights[ground]).all()
    assert (both.heights[ground] > without.heights[ground]).any()


def test_winding_and_order_do_not_matter(random_polygon):
    rng = np.random.default_rng(3)
    polygons = [random_polygon(rng) for _ in range(6)]
    forward = rasterise_polygons(polygons, RESOLUTION, 0.1)
    backward = rasterise_polygons([p[::-1] for p in polygons[::-1]], RESOLUTION, 0.1)
    np.testing.assert_allclose(forward.heights, backward.heights, atol=2e-6)


def test_a_polygon_larger_than_a_block_is_whole():
    size = 3.7 * BLOCK * 0.04
    height_map = rasterise(Scene({"a": np.array(square(0.25, size))}), 0.04)
    inside = ~np.isnan(height_map.heights)
    assert inside.sum() == pytest.approx((size / 0.04) ** 2, rel=0.02)
    rows, columns = np.flatnonzero(inside.any(axis=1)), np.flatnonzero(inside.any(axis=0))
    assert inside[rows[0] : rows[-1] + 1, columns[0] : columns[-1] + 1].all()
    assert (height_map.heights[inside] == 0.25).all()


def test_vertical_faces_have_the_height_of_their_upper_edge():
    wall = np.array([[0.0, 0, 0], [1, 0, 0], [1, 0, 5], [0, 0, 5]])
    height_map = rasterise(Scene({"a": np.array(square())}, {"wall": wall}), 0.04)
    high = np.argwhere(height_map.heights == 5.0)
    assert np.ptp(high[:, 0]) == 0
    assert np.ptp(high[:, 1]) == 25
    assert set(np.unique(height_map.heights[np.isfinite(height_map.heights)])) == {0.0, 5.0}


def test_inset_neighbours_leave_no_seam():
    config = GeneratorConfig(
        stairs_probability=0.0,
        bridge=BridgeConfig(wide_probability=1.0, wide=(2.0, 2.0), sloped_probability=0.0),
    )
    for seed in range(3):
        arena = generate_arena(config, seed)
        height_map = rasterise(arena.scene, margin=0.0)
        assert height_map.shape == (250, 250)
        void_tiles = sum(tile.kind is TileKind.VOID for row in arena.tiles for tile in row)
        assert np.isnan(height_map.heights).sum() == void_tiles * 50 * 50


@pytest.mark.parametrize("resolution", [0.0, 0.001, 0.6, -1.0, float("nan")])
def test_absurd_resolutions_are_refused(resolution, random_scene):
    with pytest.raises(InputError, match="resolution"):
        rasterise(random_scene(0), resolution)


def test_a_map_too_large_is_refused():
    near = np.array(square())
    scene = Scene({"a": near, "b": near + np.array([1e5, 1e5, 0.0])})
    with pytest.raises(InputError, match="coarser resolution"):
        rasterise(scene)


def test_polygons_of_all_sizes_make_one_map_in_bounded_memory(monkeypatch):
    rng = np.random.default_rng(4)
    polygons = [regular(3 + index % 40, rng.uniform(0.0, 4.0, 3)) for index in range(120)]
    whole = rasterise_polygons(polygons, 0.05, 0.2)
    monkeypatch.setitem(padded_groups.__globals__, "BATCH_CORNERS", 1000)
    groups = padded_groups(polygons)
    assert len(groups) > 3
    assert sum(each.shape[0] * each.shape[1] for each in groups) < 2 * sum(map(len, polygons))
    parts = rasterise_polygons(polygons, 0.05, 0.2)
    np.testing.assert_allclose(parts.heights, whole.heights, atol=1e-6)


def regular(count: int, middle: np.ndarray) -> np.ndarray:
    angle = 2.0 * np.pi * np.arange(count) / count
    return middle + 0.4 * np.stack([np.cos(angle), np.sin(angle), 0.3 * np.cos(angle)], axis=1)
