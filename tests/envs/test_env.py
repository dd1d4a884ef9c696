"""The steering environment: a slow twin, symmetries, and how episodes end."""

import jax
import numpy as np
import pytest

from jaxleas.envs.steering import RewardParams, SteeringConfig, SteeringEnv
from jaxleas.terrain.height_map import HeightMap
from jaxleas.types import RootMotion

from . import compiled
from .worlds import bumpy, flat, height_map, route_to, standing, world_of

AHEAD = np.float32([[1.0, 0.0, 0.0, 0.0]])


def make(observation="thesis144", **changes):
    env = compiled.steering_env(observation=observation, **changes)
    return env, RewardParams.of(env.config.reward)


def turned(heights: HeightMap) -> HeightMap:
    """The map turned by 90 degrees counter-clockwise about the origin: (x, y) -> (-y, x)."""
    return HeightMap(heights.heights[::-1].T.copy(), heights.resolution, heights.origin)


def mirrored(heights: HeightMap) -> HeightMap:
    """The map with y replaced by -y."""
    return HeightMap(heights.heights[::-1].copy(), heights.resolution, heights.origin)


def twin_step(env, heights: HeightMap, position, velocity, yaw, goal, action):
    """One step as one would write it on paper, for one robot, in NumPy float64."""
    limits, weights = env.config.limits, env.config.reward
    a = np.clip(np.asarray(action[:3], float), -1, 1)
    a = a / max(1.0, np.linalg.norm(a)) * limits.max_acceleration
    omega = float(np.clip(action[3], -1, 1)) * limits.max_turn_rate
    rotation = np.array([[np.cos(yaw), -np.sin(yaw), 0], [np.sin(yaw), np.cos(yaw), 0], [0, 0, 1]])
    position = position + velocity * limits.time_step
    velocity = velocity + rotation @ a * limits.time_step
    velocity = velocity / max(1.0, np.linalg.norm(velocity) / limits.max_speed)
    yaw = yaw + omega * limits.time_step
    rotation = np.array([[np.cos(yaw), -np.sin(yaw), 0], [np.sin(yaw), np.cos(yaw), 0], [0, 0, 1]])

    toward = np.array([*(goal - position[:2]), 0.0])
    toward /= np.linalg.norm(toward)
    error = np.linalg.norm(velocity - env.config.desired_speed * toward)
    reward = (
        -weights.direction * (error / (2 * limits.max_speed)) ** 2
        - weights.orientation * (1 - rotation[:, 0] @ toward)
        - weights.turn * (omega / limits.max_turn_rate) ** 2
        - weights.acceleration * (np.linalg.norm(a) / limits.max_acceleration) ** 2
    )
    seen = []
    for row in env.layout.rows:
        for column in env.layout.columns:
            point = position[:2] + rotation[:2, :2] @ [row, column]
            height = heights.height_at(point[None])[0]
            seen.append(-np.inf if np.isnan(height) else height - position[2])
    angle = np.arctan2(toward[1], toward[0]) - yaw
    angle = (angle + np.pi) % (2 * np.pi) - np.pi
    observation = [*(rotation.T @ velocity), angle]
    observation += list(np.clip(seen, env.config.height_low, env.config.height_high))
    return position, velocity, yaw, reward, np.array(observation)


@pytest.mark.parametrize("observation", ["thesis144", "icra81"])
def test_steps_equal_the_slow_twin(observation):
    env, weights = make(observation)
    heights = height_map(bumpy)
    world = world_of(heights)
    goal = np.array([3.0, 1.0])
    state = compiled.start(env, standing(env, [[-1.0, 0.5]], 0.3), route_to(goal, 1))
    twin = (np.array([-1.0, 0.5, env.robot.walking_height]), np.zeros(3), 0.3)
    rng = np.random.default_rng(0)
    unequal = 0
    for _ in range(60):
        action = rng.uniform(-1.3, 1.3, 4).astype(np.float32)
        state, outcome = compiled.step(env, world.atlas, weights, state, action[None])
        *twin, reward, observed = twin_step(env, heights, *twin, goal, action)
        np.testing.assert_allclose(state.motion.position[0], twin[0], atol=1e-5)
        np.testing.assert_allclose(state.motion.velocity[0], twin[1], atol=1e-6)
        valid = not bool(outcome.terminated[0])
        alive = valid * env.config.reward.alive
        assert outcome.reward[0] == pytest.approx(reward + alive, abs=1e-5)
        np.testing.assert_allclose(outcome.observation[0, :4], observed[:4], atol=1e-5)
        # A grid point within rounding of a cell's border may read the neighbouring cell.
        unequal += np.sum(np.abs(outcome.observation[0, 4:] - observed[4:]) > 1e-4)
    assert unequal <= 3


def random_batch(env, count=64, seed=3):
    rng = np.random.default_rng(seed)
    motion = RootMotion(
        position=np.c_[rng.uniform(-2, 2, (count, 2)), rng.uniform(0.85, 1.05, count)],
        velocity=rng.uniform(-0.1, 0.1, (count, 3)),
        yaw=rng.uniform(-np.pi, np.pi, count),
    )
    action = rng.uniform(-1, 1, (count, 4))
    return jax.tree.map(np.float32, (motion, action))


def outcomes(env, weights, heights, motion, goal, action):
    count = len(motion.yaw)
    state = compiled.start(env, motion, route_to(goal, count))
    return compiled.step(env, world_of(heights).atlas, weights, state, action)


def nearly_all_equal(left, right, tolerance=1e-4, share=0.01):
    """Equal but for the few heights whose points rounding put into a neighbouring cell."""
    assert np.mean(np.abs(np.asarray(left) - np.asarray(right)) > tolerance) < share


def test_turning_the_world_changes_nothing_the_policy_sees_or_earns():
    env, weights = make()
    heights = height_map(bumpy)
    motion, action = random_batch(env)
    x, y = motion.position[:, 0], motion.position[:, 1]
    turned_motion = RootMotion(
        position=np.stack([-y, x, motion.position[:, 2]], axis=-1),
        velocity=np.stack(
            [-motion.velocity[:, 1], motion.velocity[:, 0], motion.velocity[:, 2]], axis=-1
        ),
        yaw=motion.yaw + np.float32(np.pi / 2),
    )
    goal = [2.0, 1.0]
    _, plain = outcomes(env, weights, heights, motion, goal, action)
    _, other = outcomes(env, weights, turned(heights), turned_motion, [-1.0, 2.0], action)
    nearly_all_equal(plain.observation, other.observation)
    np.testing.assert_allclose(plain.reward, other.reward, atol=1e-5)
    nearly_all_equal(plain.margin, other.margin, share=0.05)


def test_mirroring_the_world_mirrors_what_the_policy_sees():
    env, weights = make()
    heights = height_map(bumpy)
    motion, action = random_batch(env)
    flip = np.float32([[1.0, -1.0, 1.0]])
    mirror_motion = RootMotion(motion.position * flip, motion.velocity * flip, -motion.yaw)
    goal = [2.0, 1.0]
    _, plain = outcomes(env, weights, heights, motion, goal, action)
    _, other = outcomes(
        env,
        weights,
        mirrored(heights),
        mirror_motion,
        [2.0, -1.0],
        action * np.float32([[1.0, -1.0, 1.0, -1.0]]),
    )
    seen = (
        np.asarray(plain.observation)[:, env.layout.mirror_permutation]
        * env.layout.mirror_sign[None]
    )
    nearly_all_equal(seen, other.observation)
    np.testing.assert_allclose(plain.reward, other.reward, atol=1e-5)
    nearly_all_equal(plain.margin, other.margin, share=0.05)


def test_walking_off_the_ground_terminates_and_is_not_a_truncation():
    env, weights = make()
    cliff = height_map(lambda x, y: np.where(x < 1.0, 0.0, np.nan))
    atlas = world_of(cliff).atlas
    state = compiled.start(env, standing(env, [[0.5, 0.0]], 0.0), route_to([4.0, 0.0], 1))
    for _ in range(200):
        state, outcome = compiled.step(env, atlas, weights, state, AHEAD)
        if outcome.terminated[0]:
            break
    assert outcome.terminated[0]
    assert not outcome.truncated[0]
    assert outcome.margin[0] < 0
    # R* asks for ground under the root: the robot fails within a footprint of the edge.
    assert 0.9 < float(state.motion.position[0, 0]) < 1.2


def test_running_into_a_wall_terminates():
    env, weights = make()
    wall = height_map(lambda x, y: np.where(x < 1.0, 0.0, 1.5))
    atlas = world_of(wall).atlas
    state = compiled.start(env, standing(env, [[0.5, 0.0]], 0.0), route_to([4.0, 0.0], 1))
    for _ in range(200):
        state, outcome = compiled.step(env, atlas, weights, state, AHEAD)
        if outcome.terminated[0]:
            break
    front = max(box.high[0] for box in env.robot.trunk)
    assert outcome.terminated[0]
    assert float(state.motion.position[0, 0]) == pytest.approx(1.0 - front, abs=0.08)


def test_an_episode_is_cut_after_its_steps_while_valid():
    env, weights = make(episode_steps=5)
    atlas = world_of(height_map(flat)).atlas
    state = compiled.start(env, standing(env, [[0.0, 0.0]], 0.0), route_to([4.0, 0.0], 1))
    flags = []
    for _ in range(5):
        state, outcome = compiled.step(env, atlas, weights, state, np.zeros((1, 4), np.float32))
        flags.append((bool(outcome.terminated[0]), bool(outcome.truncated[0])))
    assert flags == [(False, False)] * 4 + [(False, True)]


def test_a_goal_is_replaced_when_reached_and_when_its_time_is_up():
    env, weights = make()
    atlas = world_of(height_map(flat)).atlas
    places = [[0.0, 0.0], [-2.0, 0.0]]
    state = compiled.start(env, standing(env, places, 0.0), route_to([0.1, 0.0], 2, steps=3))
    indices, reached = [], []
    for _ in range(3):
        state, outcome = compiled.step(env, atlas, weights, state, np.zeros((2, 4), np.float32))
        indices.append(state.goal_index.tolist())
        reached.append(outcome.reached.tolist())
    # The first robot stands on both goals in turn, the second waits out its three steps.
    assert indices == [[1, 0], [2, 0], [3, 1]]
    assert reached[0] == [True, False]


@pytest.mark.slow
def test_any_batch_shape_gives_the_same_numbers():
    env, weights = make()
    atlas = world_of(height_map(bumpy)).atlas
    motion, action = random_batch(env, 12)
    state = compiled.start(env, motion, route_to([1.0, 1.0], 12))
    reshape = lambda leaf: leaf.reshape(3, 4, *leaf.shape[1:])  # noqa: E731
    step = jax.jit(env.step)
    _, one = step(atlas, weights, jax.tree.map(lambda leaf: leaf[5], state), action[5])
    _, row = step(atlas, weights, state, action)
    _, grid = step(atlas, weights, jax.tree.map(reshape, state), reshape(action))
    np.testing.assert_allclose(grid.observation.reshape(12, -1), row.observation, atol=1e-5)
    np.testing.assert_allclose(one.observation, row.observation[5], atol=1e-5)
    assert one.reward.shape == ()


def test_the_step_compiles_once():
    env, weights = make()
    atlas = world_of(height_map(flat)).atlas
    traces = 0

    def counted(state, action):
        nonlocal traces
        traces += 1
        return env.step(atlas, weights, state, action)

    step = jax.jit(counted)
    state = compiled.start(env, standing(env, [[0.0, 0.0]] * 4, 0.0), route_to([1.0, 0.0], 4))
    for _ in range(5):
        state, _ = step(state, np.zeros((4, 4), np.float32))
    assert traces == 1


def test_a_condition_of_ones_own_ends_episodes():
    config = SteeringConfig()
    env = SteeringEnv(config, condition=lambda heights, motion: motion.position[..., 0])
    atlas = world_of(height_map(flat)).atlas
    state = compiled.start(
        env, standing(env, [[-1.0, 0.0], [1.0, 0.0]], 0.0), route_to([2.0, 0.0], 2)
    )
    weights, action = RewardParams.of(config.reward), np.zeros((2, 4), np.float32)
    _, outcome = compiled.step(env, atlas, weights, state, action)
    assert outcome.terminated.tolist() == [True, False]
