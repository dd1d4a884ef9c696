"""A policy that sees more than it was trained with walks as before, until it learns."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from jaxleas.distillation.widening import widen, widen_policy
from jaxleas.envs.steering.env import SteeringEnv
from jaxleas.training.networks import make_networks
from jaxleas.training.normaliser import initial_normaliser
from jaxleas.training.policy import policy_of
from jaxleas.training.train_state import Learned
from jaxleas.types import InputError

from ..training.runs import tiny

CONFIG = tiny()


@pytest.fixture(scope="module")
def learned():
    with jax.numpy_rank_promotion("allow"):  # Brax's own code relies on it
        params = networks(CONFIG).init(jax.random.key(0), jax.random.key(1))
    normaliser = initial_normaliser(CONFIG.network, CONFIG.env.signature())
    return Learned(params, params.policy, normaliser)


def networks(config):
    return make_networks(config.network, config.env.signature())


def observations(size: int):
    return jax.random.uniform(jax.random.key(2), (32, size), minval=-1.0, maxval=1.0)


def test_nothing_changes_where_nothing_is_added(learned):
    assert widen(CONFIG, learned, None) == (CONFIG, learned)
    assert widen(CONFIG, learned, "thesis144") == (CONFIG, learned)


def test_the_wider_policy_does_what_it_did_whatever_is_new(learned):
    config, wider = widen(CONFIG, learned, "thesis145")
    assert config.env.observation == "thesis145"
    env, before = SteeringEnv(config.env), SteeringEnv(CONFIG.env)
    policy = policy_of(networks(CONFIG), CONFIG.env, learned.normaliser, learned.averaged)
    seen = observations(before.layout.size)
    more = jnp.concatenate([seen, 100.0 * observations(1)], axis=1)
    for after in (
        widen_policy(policy, env),
        policy_of(networks(config), config.env, wider.normaliser, wider.averaged),
    ):
        np.testing.assert_allclose(after.action(more), policy.action(seen), atol=1e-6)
        assert after.config.observation == "thesis145"
    assert widen_policy(policy, before) is policy


def test_actor_and_critic_fit_the_wider_environment(learned):
    config, wider = widen(CONFIG, learned, "thesis145")
    env = SteeringEnv(config.env)
    fresh = jax.eval_shape(lambda: networks(config).init(jax.random.key(0), jax.random.key(0)))
    shapes = jax.tree.map(jnp.shape, wider.params)
    assert shapes == jax.tree.map(jnp.shape, fresh)
    assert np.shape(wider.normaliser.mean) == (env.layout.size,)


def test_a_layout_that_does_not_only_add_is_refused(learned):
    with pytest.raises(InputError, match=r"does not only add.*env\.observation = icra81"):
        widen(CONFIG, learned, "icra81")
    wide = widen(CONFIG, learned, "thesis145")
    with pytest.raises(InputError, match="does not only add"):
        widen(*wide, "thesis144")


def test_a_running_normaliser_knows_nothing_of_what_is_new(learned):
    network = CONFIG.network.model_copy(update={"normaliser": "running"})
    with pytest.raises(InputError, match=r"network\.normaliser = affine"):
        widen(CONFIG.model_copy(update={"network": network}), learned, "thesis145")
