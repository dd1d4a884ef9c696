"""The rival's NumPy environment is the same task as ours."""

import subprocess
import sys

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from benchmarks.rival import write_task
from benchmarks.rivals.steering_numpy import GOALS, SteeringBatch
from benchmarks.rivals.task import read_task
from jaxleas.envs.steering import RewardParams, Steering, SteeringConfig, SteeringEnv
from jaxleas.envs.steering.starts import begin
from jaxleas.envs.steering.state import GOALS as OUR_GOALS
from jaxleas.training.worlds import training_world
from tests.training.runs import ROOT, tiny

COUNT, STEPS = 64, 60


@pytest.fixture(scope="module")
def world():
    return training_world(tiny(), Steering(tiny().env, tiny().terrain))


LAYOUTS = ["thesis144", pytest.param("icra81", marks=pytest.mark.slow)]


@pytest.fixture(scope="module", params=LAYOUTS)
def both(request, world, tmp_path_factory):
    """Our environment, and the rival's task read from the file that we write."""
    config = SteeringConfig(observation=request.param, episode_steps=40, goal_steps=(5, 20))
    env = SteeringEnv(
        config.model_copy(update={"reward": config.reward.model_copy(update={"failure": 3.0})})
    )
    path = tmp_path_factory.mktemp("task") / "task.npz"
    write_task(path, env, world)
    return env, read_task(path)


def put(batch: SteeringBatch, state) -> None:
    """Give the rival's robots the state of ours."""
    batch.position[:] = state.motion.position
    batch.velocity[:] = state.motion.velocity
    batch.yaw[:] = state.motion.yaw
    batch.map[:] = state.plan.map_index
    batch.goals[:] = state.plan.goals
    batch.goal_steps[:] = state.plan.goal_steps
    for name, value in (("goal_index", state.goal_index), ("goal_age", state.goal_age)):
        getattr(batch, name)[:] = value
    batch.steps[:] = state.step


def test_steps_equal_ours(both, world):
    env, task = both
    assert GOALS == OUR_GOALS
    weights = RewardParams.of(env.config.reward)
    keys = jax.random.key(0), jax.random.key(1)
    state, observation = jax.jit(lambda: begin(env, world, keys, COUNT, of=256))()
    batch = SteeringBatch(task, COUNT)
    put(batch, state)
    step = jax.jit(env.step)
    random = np.random.default_rng(2)
    heading = random.uniform(-1.0, 1.0, (COUNT, 4))
    unequal, flags, endings = 0, 0, np.zeros(2, int)
    unequal += np.sum(np.abs(batch.observe() - observation) > 1e-4)
    for _ in range(STEPS):
        action = (heading + random.uniform(-1.0, 1.0, (COUNT, 4))).astype(np.float32)
        state, ours = step(world.atlas, weights, state, jnp.asarray(action))
        theirs = batch.step(action)
        np.testing.assert_allclose(batch.position, state.motion.position, atol=1e-4)
        same = theirs.terminated == np.asarray(ours.terminated)
        flags += np.sum(~same)
        np.testing.assert_allclose(theirs.reward[same], ours.reward[same], atol=1e-4)
        np.testing.assert_array_equal(theirs.truncated[same], ours.truncated[same])
        np.testing.assert_allclose(theirs.observation[:, :3], ours.observation[:, :3], atol=1e-5)
        unequal += np.sum(np.abs(theirs.observation - ours.observation) > 1e-3)
        endings += [np.sum(ours.terminated), np.sum(ours.truncated)]
    # A point within rounding of a cell's border may read the neighbouring cell.
    assert unequal < 2e-4 * STEPS * COUNT * batch.size
    assert flags < 2e-3 * STEPS * COUNT
    assert np.all(endings > 0), "the comparison must have met failures and cut episodes"
    np.testing.assert_array_equal(batch.goal_index, state.goal_index)
    assert batch.goal_index.max() == GOALS - 1


def test_starts_are_valid_and_never_replayed(both, world):
    env, task = both
    batch = SteeringBatch(task, COUNT)
    seen = [batch.position.copy()]
    for _ in range(10):
        batch.restart(np.ones(COUNT, bool))
        seen.append(batch.position.copy())
    places = np.concatenate(seen)
    assert len(np.unique(places, axis=0)) == len(places)
    heights = env.local_heights(world.atlas, jnp.asarray(batch.map), motion := motion_of(batch))
    margin = np.asarray(env.condition(heights, motion))
    assert np.mean(margin >= -1e-4) > 0.99


def motion_of(batch: SteeringBatch):
    from jaxleas.types import RootMotion

    return RootMotion(*(jnp.asarray(each) for each in (batch.position, batch.velocity, batch.yaw)))


def test_only_finished_robots_are_restarted(both):
    _, task = both
    batch = SteeringBatch(task, COUNT)
    batch.steps[:] = 7
    before = batch.position.copy()
    where = np.arange(COUNT) % 3 == 0
    batch.restart(where)
    np.testing.assert_array_equal(batch.position[~where], before[~where])
    assert np.all(batch.position[where] != before[where])
    assert np.all(batch.steps == np.where(where, 0, 7))


def test_the_rival_shares_no_code_with_us():
    code = (
        "import sys, benchmarks.rivals.steering_numpy;"
        "assert not {'jaxleas', 'jax'} & sys.modules.keys(), sys.modules.keys()"
    )
    subprocess.run([sys.executable, "-c", code], check=True, cwd=ROOT)


def test_the_adapters_keep_to_the_contract(both):
    pytest.importorskip("stable_baselines3")
    from benchmarks.rivals.adapters import BatchedSteering, SingleSteering

    envs = BatchedSteering(both[1], 8)
    observation = envs.reset()
    assert observation.shape == (8, envs.batch.size)
    assert np.abs(observation).max() <= 1.0 + 1e-5
    ended = 0
    for _ in range(60):
        observation, _, done, infos = envs.step(np.ones((8, 4), np.float32))
        for index in np.flatnonzero(done):
            assert not np.array_equal(infos[index]["terminal_observation"], observation[index])
        ended += done.sum()
    assert ended >= 8
    single = SingleSteering(both[1])
    first, _ = single.reset()
    assert single.observation_space.contains(first)
