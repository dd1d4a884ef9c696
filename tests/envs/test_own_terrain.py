"""Terrain files of one's own: starts anywhere valid, goals a walk away; no file, no difference."""

from typing import Any

import jax
import numpy as np
import pytest

from jaxleas.envs.steering import SteeringConfig, SteeringEnv, make_world
from jaxleas.envs.steering.own_terrain import FARTHEST, NEAREST, make_own_terrain
from jaxleas.envs.steering.world import OwnMaps
from jaxleas.terrain.config import GeneratorConfig
from jaxleas.terrain.generator import generate_arena
from jaxleas.terrain.height_map import HeightMap
from jaxleas.types import InputError, RootMotion

from . import compiled
from .compiled import draw_pool
from .test_foresight import Patience
from .worlds import flat, height_map, world_of

ENV = compiled.steering_env()


def islands(x, y):
    """Two platforms, a wall on one, and the void between and around them."""
    ground = (np.abs(x) > 0.8) & (np.abs(x) < 4.0) & (np.abs(y) < 2.0)
    wall = (np.abs(x - 2.5) < 0.1) & (np.abs(y) < 1.0)
    return np.where(ground, np.where(wall, 1.5, 0.1 * np.sign(x)), np.nan)


def world_with(*maps: HeightMap, share: float = 1.0):
    arenas = [generate_arena(GeneratorConfig(rows=3, columns=3), seed) for seed in range(2)]
    named = [(f"map {number}", each) for number, each in enumerate(maps)]
    return make_world(arenas, maps[0].resolution, files=OwnMaps(named, share, ENV.robot))


@pytest.fixture(scope="module")
def world():
    return world_with(height_map(islands), height_map(flat, half_size=4.0))


def drawn(world, count=512, seed=0, env=ENV, least=0.5):
    pool = draw_pool(env, world, jax.random.key(seed), 2 * count)
    assert int(pool.valid_count) > least * 2 * count  # few candidates are wasted
    return compiled.take(pool, jax.random.key(seed + 1), count)[0]


def heights(world, map_index, points):
    return np.asarray(compiled.height_at(world.atlas, map_index, points))


def can_stand(world, map_index, places):
    """Whether a robot at walking height is valid over ground there, for some heading."""
    ground = heights(world, map_index, places)
    position = np.column_stack([places, ground + ENV.robot.walking_height]).astype(np.float32)
    best = np.full(len(places), -1.0)
    for yaw in np.linspace(-np.pi, np.pi, 8, endpoint=False):
        turned = np.full(len(places), yaw, np.float32)
        motion = RootMotion(position, np.zeros_like(position), turned)
        local = compiled.local_heights(ENV, world.atlas, map_index, motion)
        best = np.maximum(best, compiled.condition(ENV, local, motion))
    return (best >= 0.0) & (ground > -100.0)


def test_starts_are_valid_and_stand_at_walking_height_over_ground(world):
    state = drawn(world)
    local = compiled.local_heights(ENV, world.atlas, state.plan.map_index, state.motion)
    assert np.all(np.asarray(compiled.condition(ENV, local, state.motion)) >= 0.0)
    ground = heights(world, state.plan.map_index, np.asarray(state.motion.position)[:, :2])
    above = np.asarray(state.motion.position[:, 2]) - ground - ENV.robot.walking_height
    assert np.all((above > -0.21) & (above < 0.08))
    assert set(np.unique(state.plan.map_index)) == {2, 3}  # both files, no arena
    assert np.mean(np.asarray(state.plan.map_index) == 2) == pytest.approx(0.5, abs=0.1)


def test_goals_are_a_walk_away_one_after_another_and_can_be_stood_at(world):
    state = drawn(world)
    goals = np.asarray(state.plan.goals)
    way = np.concatenate([np.asarray(state.motion.position)[:, None, :2], goals], axis=1)
    distance = np.linalg.norm(np.diff(way, axis=1), axis=-1)
    assert np.all((distance >= NEAREST) & (distance <= FARTHEST))
    assert np.ptp(distance) > 3.0
    for number in range(goals.shape[1]):
        assert np.all(can_stand(world, state.plan.map_index, goals[:, number]))
    assert np.all(np.asarray(state.goal_index) == 0)


def test_starts_are_everywhere_that_is_valid(world):
    state = drawn(world, count=512)
    on_flat = np.asarray(state.plan.map_index) == 3
    places = np.asarray(state.motion.position)[on_flat, :2]
    cells, _, _ = np.histogram2d(*places.T, bins=4)
    assert cells.min() > 0.3 * cells.mean()
    assert len(np.unique(places[:, 0])) > 0.7 * len(places)  # candidates are drawn again
    assert np.ptp(state.motion.yaw) > 6.0


@pytest.mark.slow
def test_the_share_says_how_many_starts_fall_on_files():
    world = world_with(height_map(flat, half_size=4.0), share=0.25)
    pool = draw_pool(ENV, world, jax.random.key(0), 4096)
    assert np.mean(np.asarray(pool.state.plan.map_index) == 2) == pytest.approx(0.25, abs=0.03)


@pytest.mark.slow
def test_the_other_starts_are_those_of_a_world_without_files():
    arenas = [generate_arena(GeneratorConfig(rows=3, columns=3), seed) for seed in range(2)]
    plain = draw_pool(ENV, make_world(arenas, 0.05), jax.random.key(5), 256).state
    world = world_with(height_map(flat, half_size=4.0), share=0.5)
    mixed = draw_pool(ENV, world, jax.random.key(5), 256).state
    others = np.asarray(mixed.plan.map_index) < 2
    assert 64 < others.sum() < 192
    for left, right in zip(jax.tree.leaves(plain), jax.tree.leaves(mixed), strict=True):
        np.testing.assert_array_equal(np.asarray(left)[others], np.asarray(right)[others])


def test_a_world_without_files_draws_no_random_number_for_them():
    world = world_of(height_map(flat, half_size=3.0))
    assert world.own is None
    jaxpr = jax.make_jaxpr(lambda key: draw_pool(ENV, world, key, 8))(jax.random.key(0))
    assert "key<fry>[5]" in str(jaxpr)
    assert "key<fry>[8]" not in str(jaxpr)


@pytest.mark.parametrize("foreseen", [False, True], ids=["without", "with foresight"])
def test_the_key_of_the_starts_is_consumed_once(foreseen):
    """It was split and then folded into a sixth key, which JAX asks not to do."""
    patience: Any = Patience()
    env = SteeringEnv(SteeringConfig(), foresight=patience if foreseen else None)
    world = world_of(height_map(flat, half_size=3.0))
    jaxpr = jax.make_jaxpr(lambda key: draw_pool(env, world, key, 8))(jax.random.key(0)).jaxpr
    (key,) = jaxpr.invars
    assert sum(each is key for equation in jaxpr.eqns for each in equation.invars) == 1


def test_a_foresight_sees_files_too(world):
    env = SteeringEnv(SteeringConfig(), foresight=Patience(least=0.5))
    state = drawn(world, count=512, env=env, least=0.3)
    assert np.all(state.memory["chance"] >= 0.5)
    assert len(np.unique(state.memory["chance"])) > 90


def test_the_tables_are_the_same_every_time():
    maps = [("islands", height_map(islands))]
    one, other = (make_own_terrain(ENV.robot, maps, 1.0, 0) for _ in range(2))
    for left, right in zip(jax.tree.leaves(one), jax.tree.leaves(other), strict=True):
        np.testing.assert_array_equal(left, right)


@pytest.mark.parametrize(
    "terrain",
    [
        lambda x, y: np.where((np.abs(x) < 0.5) & (np.abs(y) < 0.5), 0.0, np.nan),
        lambda x, y: 5.0 * (x + y),
    ],
    ids=["too small to have a goal", "too steep to stand"],
)
def test_a_map_without_room_is_refused_by_its_name(terrain):
    maps = [("yard.npz", height_map(terrain, half_size=3.0))]
    with pytest.raises(InputError, match=r"yard\.npz: talos finds no two places to stand at"):
        make_own_terrain(ENV.robot, maps, 1.0, 0)


def test_maps_that_would_fill_the_memory_are_refused_before_they_do(monkeypatch):
    monkeypatch.setattr("jaxleas.envs.steering.world.MOST_CELLS", 50_000)
    said = r"map 0 has 161 x 161 cells: 3 maps padded to 161 x 161 would take .* fewer terrain\.ar"
    with pytest.raises(InputError, match=said):
        world_with(height_map(flat, half_size=4.0))


def test_surveyed_coordinates_lose_no_precision():
    far = height_map(flat, half_size=4.0)
    far = HeightMap(far.heights, far.resolution, (4_500_000.0, 5_300_000.0))
    own = world_with(far).own
    assert own is not None
    assert np.abs(own.place).max() < 10.0
