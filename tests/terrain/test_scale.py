"""Terrain for a robot of another size: Talos's is the published one, to the bit."""

from dataclasses import replace

import numpy as np
import pytest

from jaxleas.geometry import Box
from jaxleas.robots import load_robot
from jaxleas.terrain import (
    PUBLISHED,
    SCENARIOS,
    GeneratorConfig,
    Scale,
    generate_arena,
    make_scenario,
    scale_for,
    scaled,
)

PUBLISHED_CONFIG = GeneratorConfig()
HALF = Scale(0.5, 0.5, 0.5)


def test_terrain_for_talos_is_the_published_one():
    assert scale_for(load_robot("talos")) == PUBLISHED
    assert scaled(PUBLISHED_CONFIG, PUBLISHED) == PUBLISHED_CONFIG
    assert scaled(PUBLISHED_CONFIG, Scale(1.0, 1.0, 0.0)) == PUBLISHED_CONFIG  # rounded alike
    scenario = SCENARIOS["wall"](3)
    assert scenario.scaled(1.0) is scenario


def test_a_robot_is_measured_by_leg_trunk_and_sole():
    talos = load_robot("talos")
    small = replace(talos, walking_height=0.475, trunk=(Box((-0.1, -0.15, 0.0), (0.1, 0.15, 0.3)),))
    assert scale_for(small) == Scale(0.5, 0.5, 1.0)
    assert scale_for(replace(talos, trunk=())).width == 1.0
    g1 = scale_for(load_robot("g1"))
    assert (g1.leg, g1.width, g1.sole) == pytest.approx((0.7 / 0.95, 0.4 / 0.6, 0.17 / 0.2))


def test_each_length_follows_what_it_must():
    config = scaled(PUBLISHED_CONFIG, Scale(0.5, 0.8, 0.9))
    assert config.stairs.riser_max == 0.1
    assert config.stairs.climb == (0.2, 0.5)
    assert config.stairs.depth == (0.18, 0.36)  # the sole is long
    assert config.bridge.narrow == (0.24, 0.36)
    assert config.detour.rim == 0.36
    assert config.tile_size == 1.6  # room for the trunk
    for name in ("slope_max", "landing_probability"):
        assert getattr(config.stairs, name) == getattr(PUBLISHED_CONFIG.stairs, name)
    assert (config.rows, config.inset) == (PUBLISHED_CONFIG.rows, PUBLISHED_CONFIG.inset)


def test_the_bounds_of_a_field_hold_for_dwarfs_and_giants():
    assert scaled(PUBLISHED_CONFIG, Scale(0.1, 0.1, 0.1)).tile_size == 1.2
    assert scaled(PUBLISHED_CONFIG, Scale(20.0, 20.0, 20.0)).tile_size == 10.0
    assert scaled(PUBLISHED_CONFIG, Scale(1e-6, 1e-6, 1e-6)).rubble.rise == 0.001


@pytest.mark.parametrize("scale", [HALF, Scale(0.3, 0.6, 0.0), Scale(2.0, 1.5, 1.0)])
def test_arenas_of_any_scale_have_steps_within_their_bounds(scale):
    config = scaled(PUBLISHED_CONFIG, scale)
    for seed in range(3):
        arena = generate_arena(config, seed)
        climbs = [each.difficulty for each in arena.links if each.kind.startswith("stairs")]
        assert climbs
        assert max(climbs) <= 1.0 * scale.leg + 1e-3
        x = np.concatenate([each[:, 0] for each in arena.scene.surfaces.values()])
        assert x.max() <= config.columns * config.tile_size


@pytest.mark.parametrize("name", ["stairs_up", "wall", "circuit", "dead_end_platform"])
def test_a_scaled_scenario_is_similar_to_the_published_one(name):
    whole, half = make_scenario(name, 5), make_scenario(name, 5, HALF)
    for one, other in ((whole.scene.surfaces, half.scene.surfaces),
                       (whole.scene.obstacles, half.scene.obstacles)):  # fmt: skip
        assert one.keys() == other.keys()
        for key, vertices in one.items():
            np.testing.assert_array_equal(other[key], 0.5 * vertices)
    np.testing.assert_array_equal(half.goal_area, 0.5 * np.array(whole.goal_area))
    np.testing.assert_array_equal(half.start_areas, 0.5 * np.array(whole.start_areas))
    np.testing.assert_array_equal(half.waypoints, 0.5 * np.array(whole.waypoints))
