import itertools

import jax
import numpy as np
import pytest

from jaxleas.envs.steering.terrain_config import LinkShares
from jaxleas.envs.steering.world import make_world
from jaxleas.terrain.config import GeneratorConfig
from jaxleas.terrain.generator import generate_arena
from jaxleas.types import InputError

from . import compiled
from .compiled import draw_picks, draw_pool, restart_where, take
from .worlds import flat, height_map, world_of

DONE = np.arange(400) % 2 == 0
"""Whose episode is over: every other robot's."""


@pytest.fixture(scope="module")
def env():
    return compiled.steering_env()


@pytest.fixture(scope="module")
def arena_world():
    config = GeneratorConfig(rows=4, columns=4)
    return make_world([generate_arena(config, seed) for seed in range(4)], resolution=0.04)


def test_every_start_is_valid_and_its_goal_can_be_stood_at(env, arena_world):
    pool = draw_pool(env, arena_world, jax.random.key(0), 512)
    assert 0 < int(pool.valid_count) < 512  # some candidates fall: the check is not vacuous
    state, _ = take(pool, jax.random.key(1), 400)
    observation = compiled.look(env, arena_world.atlas, state)
    heights = compiled.local_heights(env, arena_world.atlas, state.plan.map_index, state.motion)
    assert np.all(np.asarray(compiled.condition(env, heights, state.motion)) >= 0.0)
    in_two_passes = compiled.observe_local_heights(env, arena_world.atlas, state)
    np.testing.assert_array_equal(observation, in_two_passes)
    first_goal = np.asarray(state.plan.goals)[:, 0]
    goal_ground = compiled.height_at(arena_world.atlas, state.plan.map_index, first_goal)
    assert np.all(np.asarray(goal_ground) > -100.0)


def test_starts_lie_in_start_areas_and_goals_in_goal_areas(env):
    world = world_of(height_map(flat), height_map(flat, half_size=3.0))
    state, _ = take(draw_pool(env, world, jax.random.key(2), 256), jax.random.key(3), 256)
    link = np.asarray(state.plan.map_index)
    for place, areas in (
        (np.asarray(state.motion.position)[:, :2], world.start_area),
        (np.asarray(state.plan.goals)[:, 0], world.goal_area),
    ):
        area = np.asarray(areas)[link]
        assert np.all((place >= area[:, 0::2]) & (place <= area[:, 1::2]))
    assert len(np.unique(link)) == 2


def test_everything_about_a_start_varies(env, arena_world):
    state, _ = take(draw_pool(env, arena_world, jax.random.key(4), 512), jax.random.key(5), 400)
    assert len(np.unique(state.plan.map_index)) == 4
    goal = np.asarray(compiled.goal(env, state))
    for values in (np.asarray(state.motion.position)[:, 0], state.motion.yaw, goal[:, 0]):
        assert len(np.unique(values)) > 160
    assert np.ptp(state.motion.yaw) > 6.0
    still = np.linalg.norm(np.asarray(state.motion.velocity), axis=1) == 0.0
    assert 0.3 < np.mean(still) < 0.7


def test_no_start_is_replayed(env, arena_world):
    """Brax's own auto-reset restores one cached start for ever; ours never does."""
    done = np.ones(400, dtype=bool)
    state, _ = take(draw_pool(env, arena_world, jax.random.key(6), 512), jax.random.key(7), 400)
    seen = []
    for number in range(5):
        pool_key, take_key = jax.random.split(jax.random.key(100 + number))
        pool = draw_pool(env, arena_world, pool_key, 512)
        pick = draw_picks(pool, take_key, done.shape)
        state = restart_where(done, state, pool, pick)
        seen.append(np.asarray(state.motion.position))
    for earlier, later in itertools.pairwise(seen):
        assert not np.any(np.all(earlier[:, None] == later[None], axis=-1))


def test_only_those_who_are_done_start_anew(env, arena_world):
    pool = draw_pool(env, arena_world, jax.random.key(8), 512)
    state, _ = take(pool, jax.random.key(9), len(DONE))
    state = state.replace(step=np.full(len(DONE), 17, dtype=np.int32))
    pick = draw_picks(pool, jax.random.key(10), DONE.shape)
    after = restart_where(DONE, state, pool, pick)
    was, now, fresh, pick = jax.tree.map(
        np.asarray, (state.motion, after.motion, pool.state.motion, pick)
    )
    np.testing.assert_array_equal(after.step, np.where(DONE, 0, 17))
    np.testing.assert_array_equal(now.position[~DONE], was.position[~DONE])
    np.testing.assert_array_equal(now.yaw[DONE], fresh.yaw[pick[DONE]])
    old, new, pooled = (
        np.asarray(compiled.look(env, arena_world.atlas, each))
        for each in (state, after, pool.state)
    )
    np.testing.assert_allclose(new, np.where(DONE[:, None], pooled[pick], old), atol=1e-5)


def test_every_valid_candidate_is_picked_alike_and_no_other(env, arena_world):
    pool = draw_pool(env, arena_world, jax.random.key(8), 512)
    count = int(pool.valid_count)
    picks = np.asarray(draw_picks(pool, jax.random.key(1), (200, count)))
    motion = pool.state.motion
    heights = compiled.local_heights(env, arena_world.atlas, pool.state.plan.map_index, motion)
    valid = np.flatnonzero(np.asarray(compiled.condition(env, heights, motion)) >= 0.0)
    often = np.bincount(picks.ravel(), minlength=512)
    assert set(np.flatnonzero(often)) == set(np.asarray(pool.order)[:count]) <= set(valid)
    assert np.all(np.abs(often[often > 0] - 200) < 6 * np.sqrt(200))


def test_nobody_starts_over_the_void(env):
    """A root measured from the void would see it at walking height: such starts must fall."""
    half = height_map(lambda x, y: np.where(x < -2.0, 0.0, np.nan))
    world = world_of(half)
    world = world.replace(goal_area=world.start_area)
    state, _ = take(draw_pool(env, world, jax.random.key(11), 4096), jax.random.key(12), 4000)
    position = np.asarray(state.motion.position)
    assert np.all(position[:, 0] < -1.8)
    assert np.all(np.abs(position[:, 2]) < 2.0)


def test_goals_of_links_to_cross_are_places_to_stand_at(env):
    """Half of the goal area is void: such goals are drawn for links alone that nobody can cross."""
    world = world_of(height_map(lambda x, y: np.where(x < 3.0, 0.0, np.nan)))
    for crossable in (True, False):
        asked = world.replace(crossable=np.array([crossable]))
        state, _ = take(draw_pool(env, asked, jax.random.key(13), 4096), jax.random.key(14), 4000)
        beyond = np.asarray(state.plan.goals)[:, 0, 0] > 3.2
        assert beyond.any() != crossable


KINDS = [*LinkShares.model_fields]


def test_starts_are_shared_among_the_kinds_of_links_as_asked(env):
    arenas = [generate_arena(GeneratorConfig(rows=4, columns=4), seed) for seed in range(3)]
    shares = dict.fromkeys(KINDS, 0.0) | {"bridge": 2.0, "stairs_up": 1.0, "cliff": 1.0}
    world = make_world(arenas, 0.04, shares)
    kinds = np.array([link.kind for arena in arenas for link in (*arena.links, *arena.dead_ends)])
    share = np.diff(np.asarray(world.cumulative_share), prepend=0.0)
    for kind, expected in (("bridge", 0.5), ("stairs_up", 0.25), ("cliff", 0.25), ("void", 0.0)):
        assert share[kinds == kind].sum() == pytest.approx(expected, abs=1e-6)
    state, _ = take(draw_pool(env, world, jax.random.key(0), 512), jax.random.key(1), 300)
    starts = np.asarray(state.motion.position)[:, :2]
    allowed = np.asarray(world.start_area)[share > 0]
    low, high = allowed[:, 0::2], allowed[:, 1::2]
    inside = np.all((starts[:, None] >= low) & (starts[:, None] <= high), axis=-1)
    assert np.all(inside.any(axis=1))


def test_shares_that_no_link_can_serve_are_refused():
    arenas = [generate_arena(GeneratorConfig(rows=1, columns=2), 0)]
    with pytest.raises(InputError, match=r"terrain\.shares"):
        make_world(arenas, 0.04, dict.fromkeys(KINDS, 0.0))


def test_dead_ends_have_starts_though_nobody_can_arrive(env):
    arenas = [generate_arena(GeneratorConfig(rows=4, columns=4), seed) for seed in range(3)]
    world = make_world(arenas, 0.04, dict.fromkeys(KINDS, 0.0) | {"void": 1.0})
    pool = draw_pool(env, world, jax.random.key(0), 512)
    assert int(pool.valid_count) > 300


def test_half_of_the_starts_are_near_and_a_fifth_wander(env):
    world = world_of(height_map(flat))
    x_min, x_max, y_min, y_max = np.asarray(world.start_area)[0]
    strip = x_max - 0.25 * (x_max - x_min)
    world = world.replace(near_area=np.array([[strip, x_max, y_min, y_max]], np.float32))
    pool = draw_pool(env, world, jax.random.key(0), 4096)
    state, _ = take(pool, jax.random.key(1), 4000)
    inside = np.asarray(state.motion.position)[:, 0] >= strip
    # Half by choice, and a quarter of the others by chance.
    assert inside.mean() == pytest.approx(0.5 + 0.5 * 0.25, abs=0.04)
    assert np.mean(np.asarray(state.goal_index) == 1) == pytest.approx(0.2, abs=0.03)


def test_the_near_strip_lies_before_what_is_to_be_crossed():
    arena = generate_arena(GeneratorConfig(rows=3, columns=3), 0)
    world = make_world([arena], 0.04)
    for link, near in zip(arena.links, np.asarray(world.near_area), strict=True):
        start, goal = np.array(link.start_area), np.array(link.goal_area)
        middle = np.array([near[:2].mean(), near[2:].mean()])
        ahead = np.array(link.direction)
        start_middle = np.array([start[:2].mean(), start[2:].mean()])
        goal_middle = np.array([goal[:2].mean(), goal[2:].mean()])
        assert 0.5 < (middle - start_middle) @ ahead < (goal_middle - start_middle) @ ahead
        depth = abs(ahead) @ np.array([near[1] - near[0], near[3] - near[2]])
        assert depth == pytest.approx(0.8, abs=1e-5)
