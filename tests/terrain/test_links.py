import numpy as np
import pytest

from jaxleas.terrain import GeneratorConfig, Tile, TileKind, generate_arena, rasterise
from jaxleas.terrain.links import find_links

CONFIG = GeneratorConfig()
FLAT, STAIRS, BRIDGE, RUBBLE = TileKind.FLAT, TileKind.STAIRS, TileKind.BRIDGE, TileKind.RUBBLE


@pytest.mark.parametrize("seed", range(15))
def test_every_link_can_be_walked_along_its_middle(seed):
    arena = generate_arena(CONFIG, seed)
    height_map = rasterise(arena.scene)
    for link in arena.links:
        start, goal = (
            np.array([0.5 * (area[0] + area[1]), 0.5 * (area[2] + area[3])])
            for area in (link.start_area, link.goal_area)
        )
        assert (goal - start) @ link.direction == pytest.approx(np.linalg.norm(goal - start))
        along = np.linspace(0.0, 1.0, 200)[:, None]
        profile = height_map.height_at(start + along * (goal - start))
        assert not np.isnan(profile).any(), link
        assert np.abs(np.diff(profile)).max() <= CONFIG.stairs.riser_max + 0.02, link
        assert profile[0] == pytest.approx(link.start_height, abs=1e-5)
        assert profile[-1] == pytest.approx(link.goal_height, abs=1e-5)


@pytest.mark.parametrize("seed", range(15))
def test_every_link_has_its_reverse(seed):
    links = generate_arena(CONFIG, seed).links
    reverse = {"stairs_up": "stairs_down", "stairs_down": "stairs_up"}
    for link in links:
        back = [
            other
            for other in links
            if other.direction == (-link.direction[0], -link.direction[1])
            and inside(other.goal_area, link.start_area)
            and inside(link.goal_area, other.start_area)
        ]
        assert len(back) == 1
        assert back[0].kind == reverse.get(link.kind, link.kind)
        assert back[0].difficulty == link.difficulty


def inside(inner, outer):
    return (
        outer[0] <= inner[0]
        and inner[1] <= outer[1]
        and outer[2] <= inner[2]
        and inner[3] <= outer[3]
    )


def initial(height, boxes=0.0):
    return Tile(TileKind.OBSTACLES if boxes else FLAT, height, height, difficulty=boxes)


@pytest.mark.parametrize(
    ("middle", "ends", "kinds"),
    [
        (Tile(STAIRS, 0.0, 0.8, (0, 1), 0.8), (0.0, 0.8), {"stairs_up", "stairs_down"}),
        (Tile(STAIRS, 0.8, 0.0, (0, -1), 0.8), (0.0, 0.8), {"stairs_up", "stairs_down"}),
        (Tile(STAIRS, 0.0, 1.3, (0, 1), 1.3), (0.0, 1.3), set()),  # too high
        (Tile(STAIRS, 0.0, 0.8, (0, 1), 0.8), (0.0, 0.0), set()),  # ends in the air
        (Tile(STAIRS, 0.0, 0.8, (1, 0), 0.8), (0.0, 0.8), set()),  # leads elsewhere
        (Tile(BRIDGE, 0.0, 0.2, (0, 1), 0.8), (0.0, 0.2), {"bridge"}),
        (Tile(BRIDGE, 0.0, 0.3, (0, 1), 0.8), (0.0, 0.3), set()),  # too steep
        (Tile(RUBBLE, 0.0, 0.05, (0, 1), 0.5), (0.0, 0.05), {"rubble"}),
        (Tile(RUBBLE, 0.0, 0.15, (0, 1), 0.5), (0.0, 0.15), set()),
        (Tile(), (0.0, 0.0), set()),
        (initial(0.0), (0.0, 0.0), {"flat"}),
        (initial(0.0, boxes=1.0), (0.0, 0.0), {"obstacles"}),
        (initial(0.5), (0.0, 0.0), set()),  # a platform in the way
    ],
)
def test_what_counts_as_a_link(middle, ends, kinds):
    links = find_links(((initial(ends[0]), middle, initial(ends[1])),), CONFIG)
    assert {link.kind for link in links} == kinds


def test_areas_of_a_link():
    middle = Tile(BRIDGE, 0.0, 0.2, (0, 1), 0.8)
    there, back = find_links(((initial(0.0), middle, initial(0.2)),), CONFIG)
    assert there.start_area == pytest.approx((0.01, 1.99, 0.01, 1.99))
    assert there.goal_area == pytest.approx((4.5, 5.5, 0.5, 1.5))
    assert (there.direction, back.direction) == ((1.0, 0.0), (-1.0, 0.0))
    assert (there.start_height, there.goal_height) == (0.0, 0.2)
    assert (back.start_height, back.goal_height) == (0.2, 0.0)
