import numpy as np
import pytest

from jaxleas.terrain.config import GeneratorConfig
from jaxleas.terrain.tiles import (
    TileFrame,
    bridge_tile,
    obstacle_tile,
    rubble_tile,
    split,
    stairs_tile,
)

CONFIG = GeneratorConfig()
FRAME = TileFrame((0.0, 0.0), (1.0, 0.0), 2.0, 0.01)
SEEDS = range(60)


def sides(vertices):
    """Return x_min, x_max, y_min, y_max of the rectangle before it was inset."""
    low, high = vertices[:, :2].min(axis=0) - 0.01, vertices[:, :2].max(axis=0) + 0.01
    return low[0], high[0], low[1], high[1]


@pytest.mark.parametrize("direction", [(0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)])
@pytest.mark.parametrize("make", [rubble_tile, bridge_tile, stairs_tile])
def test_a_turned_tile_is_the_tile_turned(make, direction):
    turned_frame = TileFrame((3.0, 4.0), direction, 2.0, 0.01)
    straight = make(FRAME, (0.0, 0.5), CONFIG, np.random.default_rng(1)).surfaces
    turned = make(turned_frame, (0.0, 0.5), CONFIG, np.random.default_rng(1)).surfaces
    rotation = np.array([[direction[0], -direction[1]], [direction[1], direction[0]]])
    for before, after in zip(straight, turned, strict=True):
        np.testing.assert_allclose(after[:, :2], before[:, :2] @ rotation.T + [3, 4], atol=1e-12)
        np.testing.assert_array_equal(after[:, 2], before[:, 2])


@pytest.mark.parametrize("seed", SEEDS)
def test_stairs_join_their_heights_in_climbable_steps(seed):
    rng = np.random.default_rng(seed)
    climb = rng.choice([-1, 1]) * rng.uniform(0.4, 1.0)
    tile = stairs_tile(FRAME, (0.3, 0.3 + climb), CONFIG, rng)
    boxes = sorted((sides(vertices), vertices[0, 2]) for vertices in tile.surfaces)
    heights = np.array([0.3, *(height for _, height in boxes), 0.3 + climb])
    risers = np.diff(heights)
    assert (np.sign(climb) * risers > -1e-9).all()
    assert np.abs(risers).max() <= CONFIG.stairs.riser_max + 1e-9
    edges = np.array([(box[0], box[1]) for box, _ in boxes])
    assert edges[0, 0] <= 0.032
    assert edges[-1, 1] >= 1.968
    np.testing.assert_allclose(edges[1:, 0], edges[:-1, 1], atol=1e-9)
    steps = [box for box, height in boxes if not np.isclose(height, [0.3, 0.3 + climb]).any()]
    depths = np.array([box[1] - box[0] for box in steps])
    widths = np.array([box[3] - box[2] for box in steps])
    assert ((depths >= 0.2 - 1e-9) & (depths <= 0.4 + 1e-9)).all()
    assert ((widths >= 1.67 - 1e-9) & (widths <= 2.0 + 1e-9)).all()


def test_bridges_are_narrow_or_wide_as_documented():
    widths = []
    for seed in range(600):
        (surface,) = bridge_tile(FRAME, (0.0, 0.1), CONFIG, np.random.default_rng(seed)).surfaces
        x_min, x_max, y_min, y_max = sides(surface)
        assert (x_min, x_max) == (pytest.approx(0.0, abs=1e-9), pytest.approx(2.0))
        assert y_max == pytest.approx(-y_min)
        widths.append(y_max - y_min)
    widths = np.array(widths)
    wide = widths >= 1.8 - 1e-9
    assert ((widths[~wide] >= 0.30 - 1e-9) & (widths[~wide] <= 0.45 + 1e-9)).all()
    assert wide.mean() == pytest.approx(0.3, abs=0.075)


@pytest.mark.parametrize("seed", range(10))
def test_rubble_covers_the_tile_with_tilted_cells(seed):
    tile = rubble_tile(FRAME, (0.2, 0.2), CONFIG, np.random.default_rng(seed))
    boxes = np.array([sides(vertices) for vertices in tile.surfaces])
    spans = np.column_stack([boxes[:, 1] - boxes[:, 0], boxes[:, 3] - boxes[:, 2]])
    assert spans.prod(axis=1).sum() == pytest.approx(4.0)
    assert ((spans >= 0.35 - 1e-9) & (spans <= 0.45 + 1e-9)).all()
    rises = np.array([np.ptp(vertices[:, 2]) for vertices in tile.surfaces])
    assert rises.max() <= 0.2 + 1e-9
    assert len(np.unique(rises.round(9))) == len(rises)
    assert 0.0 < tile.difficulty <= 1.0


@pytest.mark.parametrize("seed", range(30))
def test_boxes_stand_clear_of_the_centre_and_on_the_tile(seed):
    config = GeneratorConfig.model_validate({"obstacles": {"count": 2}})
    tile = obstacle_tile(FRAME, 0.5, config, np.random.default_rng(seed))
    assert len(tile.boxes) == 2
    for faces in tile.boxes:
        top = faces["top"]
        assert 0.7 <= top[0, 2] - 0.5 <= 2.0
        offset = np.abs(top[:, :2] - [1.0, 0.0])
        assert ((offset.min(axis=0) >= 0.3 - 1e-9) & (offset.min(axis=0) <= 0.5 + 1e-9)).all()
        assert (offset <= 1.0 + 1e-9).all()
        assert faces["side_0"][:, 2].min() == 0.5


@pytest.mark.parametrize("seed", range(30))
def test_split_keeps_total_and_interval(seed):
    rng = np.random.default_rng(seed)
    count = int(rng.integers(5, 11))
    lengths = split(rng, 2.0, count, (0.2, 0.4))
    assert len(lengths) == count
    assert lengths.sum() == pytest.approx(2.0)
    assert ((lengths >= 0.2 - 1e-9) & (lengths <= 0.4 + 1e-9)).all()
