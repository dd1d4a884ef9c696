"""Holes and walls to be walked round, and dead ends to stop at."""

import numpy as np
import pytest

from jaxleas.terrain import GeneratorConfig, TileKind, generate_arena, rasterise
from jaxleas.terrain.tiles import TileFrame, hole_tile, wall_tile

CONFIG = GeneratorConfig(rows=5, columns=5, detour_probability=0.5)
FRAME = TileFrame((0.0, 0.0), (1.0, 0.0), 2.0, 0.01)


def across(tile):
    """Heights over the tile, [s, t], NaN in a hole."""
    from jaxleas.terrain import Scene

    obstacles = {f"{n}_{k}": face for n, box in enumerate(tile.boxes) for k, face in box.items()}
    scene = Scene({f"s{n}": each for n, each in enumerate(tile.surfaces)}, obstacles)
    grid = rasterise(scene, 0.02, margin=0.0)
    s, t = np.meshgrid(np.arange(0.02, 2.0, 0.02), np.arange(-0.98, 1.0, 0.02), indexing="ij")
    return grid.height_at(np.stack([s.ravel(), t.ravel()], axis=-1)).reshape(s.shape), t[0]


@pytest.mark.parametrize("seed", range(20))
def test_a_hole_leaves_a_rim_at_either_side(seed):
    heights, t = across(hole_tile(FRAME, (0.3, 0.3), CONFIG, np.random.default_rng(seed)))
    hole = t[np.isnan(heights).any(axis=0)]
    assert CONFIG.detour.width[0] - 0.06 < np.ptp(hole) < CONFIG.detour.width[1]
    assert hole.min() > -1.0 + CONFIG.detour.rim - 0.05
    assert hole.max() < 1.0 - CONFIG.detour.rim + 0.05
    np.testing.assert_allclose(heights[~np.isnan(heights)], 0.3, atol=1e-6)


@pytest.mark.parametrize("seed", range(20))
def test_a_wall_leaves_a_passage_at_one_side(seed):
    heights, t = across(wall_tile(FRAME, (0.0, 0.0), CONFIG, np.random.default_rng(seed)))
    walled = t[(heights > 0.5).any(axis=0)]
    passage = 2.0 - np.ptp(walled)
    assert passage > 2.0 - CONFIG.detour.width[1] - 0.05
    assert (walled.min() < -0.95) != (walled.max() > 0.95)
    assert not np.isnan(heights).any()


def test_arenas_link_over_detours_both_ways_and_the_thesiss_generator_has_none():
    kinds, tiles = [], []
    for seed in range(10):
        arena = generate_arena(CONFIG, seed)
        kinds += [link.kind for link in arena.links]
        tiles += [tile.kind for row in arena.tiles for tile in row]
        plain = generate_arena(GeneratorConfig(rows=5, columns=5), seed)
        assert "detour" not in {link.kind for link in plain.links}
    assert kinds.count("detour") >= 20
    assert kinds.count("detour") % 2 == 0
    assert TileKind.HOLE in tiles
    assert TileKind.WALL in tiles


def test_dead_ends_end_in_the_void_or_at_a_cliff():
    found = set()
    for seed in range(10):
        arena = generate_arena(CONFIG, seed)
        ground = rasterise(arena.scene, 0.04)
        for link in arena.dead_ends:
            x, y = np.mean(link.goal_area[:2]), np.mean(link.goal_area[2:])
            height = ground.height_at(np.array([[x, y]]))[0]
            if link.kind == "void":
                assert np.isnan(height)
            else:
                assert abs(link.goal_height - link.start_height) > CONFIG.cliff_above
                assert link.difficulty == pytest.approx(abs(link.goal_height - link.start_height))
            found.add(link.kind)
    assert found == {"void", "cliff"}
