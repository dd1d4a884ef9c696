"""Which guide paths the planner is asked about, and how they are walked."""

import jax
import numpy as np
import pytest

from jaxleas.distillation.collect import WalksWanted, collect
from jaxleas.distillation.labelling import choose
from jaxleas.envs.steering import SteeringConfig, SteeringEnv
from jaxleas.envs.steering.world import make_world
from jaxleas.terrain.config import GeneratorConfig
from jaxleas.terrain.generator import generate_arena

from ..guide.walkers import random_policy

STEPS = 12


def test_half_is_chosen_at_random_and_half_where_it_is_least_sure():
    failure = np.concatenate([np.zeros(500), np.full(100, 0.5), np.ones(400)])
    chosen = choose(failure, 200, np.random.default_rng(0))
    assert len(np.unique(chosen)) == 200
    unsure = np.sum((chosen >= 500) & (chosen < 600))
    assert unsure >= 90  # nearly all that the random half left over
    assert np.sum(chosen < 500) > 20  # and the random half reaches everywhere
    assert np.sum(chosen >= 600) > 20


@pytest.fixture(scope="module")
def walks():
    env = SteeringEnv(SteeringConfig())
    world = make_world([generate_arena(GeneratorConfig(rows=3, columns=3), 0)], resolution=0.05)
    disturbed, calm = (
        collect(env, world, random_policy(), jax.random.key(0), WalksWanted(64, STEPS, kinds))
        for kinds in (np.array([0.0, 0.5]), np.array([0.0]))
    )
    return env, disturbed, calm


def test_an_undisturbed_walk_is_the_policys_own(walks):
    _, disturbed, calm = walks
    np.testing.assert_array_equal(disturbed.motion.yaw[::2], calm.motion.yaw[::2])
    assert np.all(np.any(disturbed.motion.yaw[1::2] != calm.motion.yaw[1::2], axis=1))


def test_guide_paths_end_before_their_first_invalid_configuration(walks):
    env, disturbed, _ = walks
    paths = disturbed.paths(env.config.limits.time_step)
    lengths = np.array([len(path) for path in paths])
    assert np.all(lengths >= 1)
    np.testing.assert_array_equal(lengths, disturbed.valid.sum(axis=1))
    for path, whole in zip(paths, disturbed.motion.position, strict=True):
        np.testing.assert_array_equal(path.position, whole[: len(path)])
        step = np.diff(path.position[:, :2], axis=0) if len(path) > 1 else np.zeros((1, 2))
        assert np.all(np.linalg.norm(step, axis=1) <= 0.2 * 0.2 + 1e-5)  # v_max T


def test_some_of_the_walks_are_as_good_as_all_of_them(walks):
    _, disturbed, _ = walks
    some = disturbed[np.array([3, 5])]
    assert len(some) == 2
    np.testing.assert_array_equal(some.motion.position[1], disturbed.motion.position[5])
