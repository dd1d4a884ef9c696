"""Limits of the generator: their links, sizes, and where they lie."""

from collections import Counter

import numpy as np
import pytest

from jaxleas.terrain import GeneratorConfig, generate_arena, rasterise
from jaxleas.terrain.config import LimitsConfig
from jaxleas.terrain.tiles import LIMITS, TileFrame, TileKind, limit_tile

CONFIG = GeneratorConfig(limit_probability=1.0)
FRAME = TileFrame((0.0, 0.0), (1.0, 0.0), 2.0, 0.01)


def tile(kind, seed):
    rise = 0.4 if kind is TileKind.LEDGE else 0.0
    return limit_tile(FRAME, (1.0, 1.0 + rise), CONFIG, np.random.default_rng(seed), kind)


def test_arenas_have_links_of_all_kinds_both_ways():
    kinds = Counter(link.kind for seed in range(12) for link in generate_arena(CONFIG, seed).links)
    for kind in ("ledge", "gap", "barrier", "posts"):
        assert kinds[kind] >= 10
        assert kinds[kind] % 2 == 0


def test_without_a_probability_no_arena_changes():
    plain, other = GeneratorConfig(), GeneratorConfig(limits=LimitsConfig(gap=(0.1, 0.2)))
    for seed in range(5):
        before, after = generate_arena(plain, seed), generate_arena(other, seed)
        assert before.links == after.links
        for name, polygon in before.scene.surfaces.items():
            np.testing.assert_array_equal(polygon, after.scene.surfaces[name])


@pytest.mark.parametrize("kind", LIMITS)
def test_a_limit_stays_within_its_tile(kind):
    for seed in range(30):
        polygons = tile(kind, seed)
        corners = np.concatenate(
            [*polygons.surfaces, *(face for box in polygons.boxes for face in box.values())]
        )
        # A thick bar that lies askew sticks out at its ends by half its thickness.
        assert np.abs(corners[:, 0] - 1.0).max() <= 1.0 + 0.15
        assert np.abs(corners[:, 1]).max() <= 1.0 + 0.15


def test_a_gap_is_as_wide_as_its_difficulty():
    for seed in range(20):
        polygons = tile(TileKind.GAP, seed)
        before, behind = polygons.surfaces
        area = sum(_area(part) for part in (before, behind))
        assert CONFIG.limits.gap[0] <= polygons.difficulty <= CONFIG.limits.gap[1]
        lost = 1.98**2 - area
        # The gap crosses the tile at up to 45 degrees.
        assert 1.97 * polygons.difficulty <= lost <= 1.99 * np.sqrt(2.0) * polygons.difficulty


def test_a_ledge_lies_between_its_heights():
    before, behind = tile(TileKind.LEDGE, 3).surfaces
    assert (before[:, 2] == 1.0).all()
    np.testing.assert_allclose(behind[:, 2], 1.4)


def test_posts_leave_their_room():
    for seed in range(20):
        polygons = tile(TileKind.POSTS, seed)
        middles = np.array([box["top"].mean(axis=0)[:2] for box in polygons.boxes])
        middles = middles[np.argsort(middles[:, 1])]
        apart = np.linalg.norm(np.diff(middles, axis=0), axis=1)
        thick = np.linalg.norm(np.diff(polygons.boxes[0]["top"][:2], axis=0))
        np.testing.assert_allclose(apart, thick - polygons.difficulty, atol=1e-9)


def test_thin_barriers_reach_the_map():
    config = GeneratorConfig(
        limit_probability=1.0, limits=LimitsConfig(thickness=(0.02, 0.021), hurdle=(0.6, 0.7))
    )
    for seed in range(6):
        arena = generate_arena(config, seed)
        heights = rasterise(arena.scene, 0.04)
        for link in (each for each in arena.links if each.kind == "barrier"):
            x, y = (0.5 * (low + high) for low, high in (link.start_area[:2], link.start_area[2:]))
            far = np.array(link.direction) * 4.0
            way = np.array([x, y]) + np.linspace(0.0, 1.0, 400)[:, None] * far
            top = np.nanmax(heights.height_at(way)) - link.start_height
            assert top > 0.5


def _area(polygon):
    x, y = polygon[:, 0], polygon[:, 1]
    return 0.5 * abs(x @ np.roll(y, -1) - y @ np.roll(x, -1))
