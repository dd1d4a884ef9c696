"""The guard: what it keeps, what it lets pass, and how far a braking robot goes."""

from functools import partial

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from jaxleas.conditions import EXACT_TWINS, STANDARD
from jaxleas.envs.steering import GOALS, MotionLimits, Route, integrate
from jaxleas.envs.steering.config import GuardConfig
from jaxleas.envs.steering.guard import Guard
from jaxleas.envs.steering.motion import scale_action
from jaxleas.guide import Trips, roll_out
from jaxleas.terrain import make_atlas, rasterise
from jaxleas.terrain.scenarios.limits import LIMITS as LIMITS_BY_NAME
from jaxleas.types import RootMotion
from tests.envs import compiled
from tests.envs.worlds import height_map, standing, world_of

LIMITS = MotionLimits()
FRONT = 0.133  # x of the front of Talos's lowest trunk box [m]


def guarded_env(**changes):
    return compiled.steering_env(guard=GuardConfig(enabled=True, **changes))


def motion_of(positions, velocities, yaws):
    return RootMotion(
        jnp.asarray(positions, jnp.float32),
        jnp.asarray(velocities, jnp.float32),
        jnp.asarray(yaws, jnp.float32),
    )


def twice(margin):
    """The margins of a world in which no room is spared."""
    return jnp.stack([margin, margin], axis=-1)


def braking(position, velocity):
    """Brake as hard as the limits allow, one time step at a time, in plain NumPy."""
    position, velocity = np.array(position, float), np.array(velocity, float)
    visited = [position.copy()]
    loss = LIMITS.max_acceleration * LIMITS.time_step
    while (speed := np.linalg.norm(velocity)) > 1e-9:
        position += velocity * LIMITS.time_step
        velocity *= max(speed - loss, 0.0) / speed
        visited.append(position.copy())
    return np.array(visited)


def test_robots_are_asked_for_each_configuration_until_they_rest():
    """Which may be invalid is up to the margin: here, all beyond a line, seen by plain braking."""
    random = np.random.default_rng(0)
    velocity = random.normal(size=(60, 3))
    velocity *= random.uniform(0.0, LIMITS.max_speed, (60, 1)) / np.linalg.norm(
        velocity, axis=1, keepdims=True
    )
    position = random.uniform(-0.05, 0.04, (60, 3))
    visited = [braking(*each) for each in zip(position, velocity, strict=True)]
    line = 0.02

    def before_line(atlas, map_index, motion):
        return twice(line - motion.position[..., 0])

    motion = motion_of(position, velocity, np.zeros(60))
    index, room = jnp.zeros(60, jnp.int32), jnp.zeros(60)
    found = Guard(LIMITS, before_line).can_stop(None, index, room, motion)
    wanted = [bool((each[:, 0] <= line).all()) for each in visited]
    assert 15 < sum(wanted) < 45
    np.testing.assert_array_equal(found, wanted)


def test_a_hole_on_the_way_to_rest_is_seen_though_rest_is_valid():
    visited = braking([0.0, 0.0, 1.0], [0.2, 0.0, 0.0])
    hole = visited[5, 0]

    def around_hole(atlas, map_index, motion):
        return twice(jnp.abs(motion.position[..., 0] - hole) - 1e-4)

    motion = motion_of([[0.0, 0.0, 1.0]], [[0.2, 0.0, 0.0]], [0.0])
    index, room = jnp.zeros(1, jnp.int32), jnp.zeros(1)
    assert not Guard(LIMITS, around_hole).can_stop(None, index, room, motion).any()


def no_limit(atlas, map_index, motion):
    return twice(jnp.ones(motion.yaw.shape))


def test_robot_that_must_not_move_on_brakes_as_hard_as_it_can():
    def never(atlas, map_index, motion):
        return twice(-jnp.ones(motion.yaw.shape))

    now = motion_of([[0.0, 0.0, 1.0]] * 2, [[0.1, 0.05, 0.02], [0.01, 0.0, 0.0]], [0.3, 0.3])
    asked = integrate(now, jnp.array([[0.05, 0.0, 0.0, 0.3]] * 2), LIMITS)
    kept = Guard(LIMITS, never)(None, jnp.zeros(2, jnp.int32), now, asked)
    for robot in range(2):
        visited = braking(now.position[robot], now.velocity[robot])
        np.testing.assert_allclose(kept.position[robot], visited[1], atol=1e-6)
        after = visited[2] if len(visited) > 2 else visited[1]
        step = np.asarray(kept.velocity[robot]) * LIMITS.time_step
        np.testing.assert_allclose(kept.position[robot] + step, after, atol=1e-6)
    np.testing.assert_array_equal(kept.yaw, now.yaw)


def test_what_can_be_obeyed_is_obeyed_to_the_last_bit():
    now = motion_of([[0.0, 0.0, 1.0]], [[0.1, 0.0, 0.0]], [0.3])
    asked = integrate(now, jnp.array([[0.05, 0.02, 0.0, 0.3]]), LIMITS)
    kept = Guard(LIMITS, no_limit)(None, jnp.zeros(1, jnp.int32), now, asked)
    jax.tree.map(np.testing.assert_array_equal, kept, asked)


def test_where_only_the_turn_would_fail_the_robot_goes_on_without_it():
    def no_turned(atlas, map_index, motion):
        return twice(jnp.where(jnp.abs(motion.yaw) > 0.01, -1.0, 1.0))

    now = motion_of([[0.0, 0.0, 1.0]], [[0.1, 0.0, 0.0]], [0.0])
    asked = integrate(now, jnp.array([[0.05, 0.0, 0.0, 0.3]]), LIMITS)
    kept = Guard(LIMITS, no_turned)(None, jnp.zeros(1, jnp.int32), now, asked)
    np.testing.assert_array_equal(kept.velocity, asked.velocity)
    np.testing.assert_array_equal(kept.yaw, now.yaw)


def test_a_robot_that_is_too_low_to_go_ahead_rises_as_asked_and_then_goes():
    """Beyond x = 0 roots must be higher than 1.03 m; the command asks for ahead and up."""

    def high_beyond(atlas, map_index, motion):
        x, z = motion.position[..., 0], motion.position[..., 2]
        return twice(jnp.where(x > 0.0, z - 1.03, 1.0))

    guard, motion = Guard(LIMITS, high_beyond), motion_of([[0.0, 0.0, 1.0]], [[0.0] * 3], [0.2])
    action = jnp.asarray([[1.0, 0.0, 0.7, 0.5]])
    motions = walk(guard, None, jnp.zeros(1, jnp.int32), motion, jnp.repeat(action[None], 30, 0))
    x, z = np.asarray(motions.position[:, 0, 0]), np.asarray(motions.position[:, 0, 2])
    assert x[-1] > 0.1
    assert (z[x > 0.0] >= 1.03).all()
    assert z[(x == 0.0).sum() - 1] > 1.02


def test_whatever_the_guard_lets_pass_keeps_the_limits_of_motion():
    random = np.random.default_rng(3)
    count = 300
    velocity = random.normal(size=(count, 3))
    speed = random.uniform(0.0, LIMITS.max_speed, (count, 1))
    velocity *= speed / np.linalg.norm(velocity, axis=1, keepdims=True)
    now = motion_of(np.zeros((count, 3)), velocity, np.zeros(count))
    actions = jnp.asarray(random.uniform(-1.0, 1.0, (count, 4)), jnp.float32)
    asked = integrate(now, scale_action(actions, LIMITS), LIMITS)

    def level_only(atlas, map_index, motion):
        return twice(0.02 - jnp.abs(motion.velocity[..., 0]))

    kept = Guard(LIMITS, level_only)(None, jnp.zeros(count, jnp.int32), now, asked)
    change = np.linalg.norm(np.asarray(kept.velocity) - velocity, axis=1)
    assert change.max() <= LIMITS.max_acceleration * LIMITS.time_step + 1e-6
    assert np.linalg.norm(kept.velocity, axis=1).max() <= LIMITS.max_speed + 1e-6
    differs = np.any(np.asarray(kept.velocity) != np.asarray(asked.velocity), axis=1)
    assert 0.2 < differs.mean() < 1.0


KINDS = ("ledge_down", "gap", "posts", "thin_wall")
ROBOTS, STEPS = 64, 120


@partial(jax.jit, static_argnums=0)
def walk(guard, atlas, map_index, motion, actions):
    """Return the motions of robots that are asked for `actions`, step by step."""

    def step(motion, action):
        asked = integrate(motion, scale_action(action, LIMITS), LIMITS)
        kept = asked if guard is None else guard(atlas, map_index, motion, asked)
        return kept, kept

    return jax.lax.scan(step, motion, actions)[1]


@pytest.fixture(scope="module")
def courses():
    """Scenes with what can hardly be crossed, and robots that stand before it."""
    scenes = [LIMITS_BY_NAME[kind](3).scene for kind in KINDS]
    random = np.random.default_rng(5)
    map_index = np.arange(ROBOTS) % len(KINDS)
    place = np.column_stack([random.uniform(-1.2, -0.6, ROBOTS), random.uniform(-0.3, 0.3, ROBOTS)])
    env = guarded_env()
    motion = standing(env, place, random.uniform(-0.6, 0.6, ROBOTS))
    route = Route(
        map_index=jnp.asarray(map_index, jnp.int32),
        goals=jnp.full((ROBOTS, GOALS, 2), 50.0),
        goal_steps=jnp.full((ROBOTS, GOALS), 10_000),
    )
    atlas = make_atlas([rasterise(scene, 0.04) for scene in scenes])
    # Ahead as fast as possible, with turns and lifts that change now and then.
    actions = np.repeat(random.uniform(-1.0, 1.0, (STEPS // 10, ROBOTS, 4)), 10, axis=0)
    actions[..., 0] = 1.0
    return scenes, atlas, motion, route, jnp.asarray(actions, jnp.float32)


def test_whatever_it_is_asked_to_do_a_guarded_robot_stays_valid_on_the_polygons(courses):
    scenes, atlas, motion, route, actions = courses
    map_index, env = np.asarray(route.map_index), guarded_env()

    def share_invalid(guard):
        motions = walk(guard, atlas, route.map_index, motion, actions)
        maps = jnp.broadcast_to(route.map_index[None], motions.yaw.shape)
        fails = ~(np.asarray(compiled.margin(env, atlas, maps, motions)) >= 0.0).all(axis=0)
        for index, scene in enumerate(scenes):
            for robot in np.flatnonzero(map_index == index):
                each = np.asarray(motions.position[:, robot]), np.asarray(motions.yaw[:, robot])
                holds = [EXACT_TWINS[name](env.robot, scene, *each) for name in STANDARD]
                fails[robot] |= not np.logical_and.reduce(holds).all()
        return fails.mean(), np.asarray(motions.position[-1, :, 0])

    guarded, reached = share_invalid(env.guard)
    assert guarded == 0.0
    assert share_invalid(None)[0] > 0.5
    # It is no robot that refuses to move: most go on to what they cannot cross.
    assert np.median(reached - np.asarray(motion.position[:, 0])) > 0.3


def test_a_policys_guard_watches_over_its_roll_outs_and_over_no_other_method(courses):
    _, atlas, motion, route, _ = courses
    env = guarded_env()

    class Ahead:
        def __init__(self, guarded):
            self.guarded = guarded

        def __call__(self, heights_in_root, motion, goal):
            command = jnp.zeros((*motion.yaw.shape, 4)).at[..., 0].set(0.08)
            return integrate(motion, command, env.config.limits)

    waypoints = jnp.full((ROBOTS, 1, 3), 50.0)
    trips = Trips(atlas, route.map_index, motion, waypoints)
    assert not np.any(roll_out(env, Ahead(True), trips, STEPS).invalid)
    assert np.all(roll_out(env, Ahead(False), trips, STEPS).invalid)


def test_room_that_it_leaves_is_what_the_configuration_states():
    """A wall from x = 0 on: how far from it a robot comes to rest that is asked to walk on."""
    wall = height_map(lambda x, y: np.where(x > 0.0, 1.5, 0.0), 3.0, resolution=0.01)
    atlas = world_of(wall).atlas
    rest = {}
    for spare in (0.0, 0.05):
        env = guarded_env(spare=spare)
        motion = standing(env, [[-1.0, 0.0]], 0.0)
        ahead = jnp.zeros((STEPS, 1, 4)).at[..., 0].set(1.0)
        motions = walk(env.guard, atlas, jnp.zeros(1, jnp.int32), motion, ahead)
        rest[spare] = float(motions.position[-1, 0, 0])
    assert rest[0.0] - rest[0.05] == pytest.approx(0.05, abs=0.02)
    # The wall's first cell begins half a cell before its centre.
    assert -FRONT - 0.05 < rest[0.0] <= -FRONT + 0.006


def test_a_robot_that_begins_with_less_room_may_leave_and_stays_valid():
    """A wall from x = 0 on, and a robot 3 cm before it, where 5 cm are to be spared."""
    wall = height_map(lambda x, y: np.where(x > 0.0, 1.5, 0.0), 3.0, resolution=0.01)
    atlas, env = world_of(wall).atlas, guarded_env(spare=0.05)
    begin, index = -FRONT - 0.03, jnp.zeros(1, jnp.int32)
    for direction, way in ((-1.0, -0.5), (1.0, 0.0)):
        asked = jnp.zeros((STEPS, 1, 4)).at[..., 0].set(direction)
        motions = walk(env.guard, atlas, index, standing(env, [[begin, 0.0]], 0.0), asked)
        end = float(motions.position[-1, 0, 0])
        assert end < begin + way if way else begin <= end <= -FRONT + 0.006
