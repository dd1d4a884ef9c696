import collections

import numpy as np
import pytest
from pydantic import ValidationError

from jaxleas.terrain import GeneratorConfig, TileKind, generate_arena, rasterise
from jaxleas.terrain.generator import _Builder
from jaxleas.terrain.scene_file import require_valid

SEEDS = range(15)


@pytest.fixture(scope="module")
def arenas():
    return [generate_arena(GeneratorConfig(), seed) for seed in SEEDS]


def test_a_seed_gives_one_arena_and_seeds_differ(arenas):
    again = generate_arena(GeneratorConfig(), 3)
    assert again.tiles == arenas[3].tiles
    assert again.links == arenas[3].links
    for name, vertices in arenas[3].scene.surfaces.items():
        np.testing.assert_array_equal(again.scene.surfaces[name], vertices)
    assert len({arena.tiles for arena in arenas}) == len(arenas)


def test_every_polygon_is_planar_convex_and_counter_clockwise(arenas):
    for seed, arena in enumerate(arenas):
        require_valid(arena.scene, f"seed {seed}")


def test_initial_tiles_stand_at_their_height(arenas):
    for arena in arenas[:10]:
        height_map = rasterise(arena.scene)
        for (row, column), tile in np.ndenumerate(np.array(arena.tiles, dtype=object)):
            centre = np.array([[2.0 * column + 1.0, 2.0 * row + 1.0]])
            if tile.kind.is_initial:
                assert height_map.height_at(centre)[0] == pytest.approx(tile.height, abs=1e-5)


def test_surfaces_do_not_overlap(arenas):
    # insets keep contact surfaces apart: what they cover adds up to what their union covers
    for arena in arenas[:5]:
        boxes = np.array(
            [(*v[:, :2].min(axis=0), *v[:, :2].max(axis=0)) for v in arena.scene.surfaces.values()]
        )
        apart = (boxes[:, None, :2] >= boxes[None, :, 2:] - 1e-9).any(axis=-1)
        apart |= apart.T | np.eye(len(boxes), dtype=bool)
        assert apart.all()


def test_transitions_into_the_empty_follow_the_documented_odds():
    builder = _Builder(GeneratorConfig(), np.random.default_rng(0))
    drawn = [builder.draw_transition(1.0) for _ in range(6000)]
    counts = collections.Counter(kind for kind, _ in drawn)
    assert counts[TileKind.STAIRS] / 6000 == pytest.approx(0.55, abs=0.025)
    assert counts[TileKind.BRIDGE] / 6000 == pytest.approx(0.30, abs=0.025)
    assert counts[TileKind.RUBBLE] / 6000 == pytest.approx(0.15, abs=0.02)
    climbs = np.array([height - 1.0 for kind, height in drawn if kind is TileKind.STAIRS])
    assert (np.abs(climbs) >= 0.4).all()
    assert (np.abs(climbs) <= 1.0).all()
    assert np.mean(climbs > 0.0) == pytest.approx(0.5, abs=0.05)


def test_half_of_the_initial_tiles_carry_obstacles(arenas):
    kinds = [t.kind for arena in arenas for row in arena.tiles for t in row if t.kind.is_initial]
    share = np.mean([kind is TileKind.OBSTACLES for kind in kinds])
    assert share == pytest.approx(0.5, abs=4.0 * 0.5 / np.sqrt(len(kinds)))


def test_an_arena_of_the_thesis_has_about_its_links():
    # T fig. 3.12: 5 x 30 tiles, 17 bridges, 31 stairs, 8 rubbles (we list each link both ways)
    links = collections.Counter(
        link.kind
        for seed in range(12)
        for link in generate_arena(GeneratorConfig(rows=5, columns=30), seed).links
    )
    undirected = {kind: count / 24 for kind, count in links.items()}
    assert undirected["stairs_up"] + undirected["stairs_down"] == pytest.approx(31, abs=6)
    assert undirected["bridge"] == pytest.approx(17, abs=4)
    assert undirected["rubble"] == pytest.approx(8, abs=3)
    assert links["stairs_up"] == links["stairs_down"]


def test_probabilities_at_their_ends():
    plain = GeneratorConfig(transition_probability=0.0)
    kinds = {tile.kind for row in generate_arena(plain, 0).tiles for tile in row}
    assert kinds == {TileKind.FLAT, TileKind.OBSTACLES}
    bare = GeneratorConfig.model_validate({"obstacles": {"probability": 0.0}})
    arena = generate_arena(bare, 0)
    assert not arena.scene.obstacles
    assert TileKind.OBSTACLES not in {tile.kind for row in arena.tiles for tile in row}


def test_one_tile_is_an_arena():
    arena = generate_arena(GeneratorConfig(rows=1, columns=1), 0)
    assert arena.tiles[0][0].kind.is_initial
    assert arena.links == ()


@pytest.mark.parametrize(
    "field",
    [
        {"rows": 0},
        {"transition_probability": 1.5},
        {"stairs": {"climb": (1.0, 0.4)}},
        {"bridge": {"narrow": (-0.3, 0.4)}},
        {"stares_probability": 0.5},
        {"tile_size": float("nan")},
        {"stairs_probability": 0.8, "bridge_probability": 0.3},
    ],
)
def test_configurations_that_make_no_sense_are_refused(field):
    with pytest.raises(ValidationError):
        GeneratorConfig.model_validate(field)
