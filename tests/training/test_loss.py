"""Our PPO loss is Brax's: values and gradients, over batches with ends of every kind."""

import functools
from types import SimpleNamespace
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from jaxleas.envs.steering import SteeringConfig
from jaxleas.training.brax_blocks import (
    ACTIVATION,
    Transition,
    compute_ppo_loss,
    make_ppo_networks,
)
from jaxleas.training.config import NetworkConfig
from jaxleas.training.loss import Experience, Minibatch, advantages, ppo_loss
from jaxleas.training.networks import make_networks
from jaxleas.training.normaliser import initial_normaliser, normalise
from jaxleas.training.ppo_params import PpoParams

from .runs import SteeringRun

pytestmark = pytest.mark.usefixtures("brax_ranks")

TIME, ROBOTS = 7, 12
SAMPLES = (TIME, ROBOTS)
SIGNATURE = SteeringConfig().signature()


def brax_networks(config):
    """Return Brax's own networks of the same sizes."""
    return make_ppo_networks(
        observation_size=SIGNATURE.size,
        action_size=SIGNATURE.action_size,
        preprocess_observations_fn=normalise,
        policy_hidden_layer_sizes=config.hidden,
        value_hidden_layer_sizes=config.hidden,
        activation=ACTIVATION[config.activation],
    )


def walked(networks, params, normaliser, seed):
    """Return a batch, walked by a policy a little other than `params`, in both forms."""
    keys = jax.random.split(jax.random.key(seed), 3)
    observation, last = (
        jax.random.uniform(key, (*shape, SIGNATURE.size), minval=-1.0)
        for key, shape in zip(keys, (SAMPLES, (ROBOTS,)), strict=False)
    )
    walker = jax.tree.map(
        lambda leaf: 1.1 * leaf + 0.02 * jax.random.normal(keys[2], leaf.shape), params.policy
    )
    logits = networks.policy_network.apply(normaliser, walker, observation)
    distributions = SIGNATURE.distributions(logits)
    noise = SIGNATURE.draw_noise(jax.random.key(seed + 1), SAMPLES)
    raw = SIGNATURE.sample(distributions, noise)
    ends = np.random.default_rng(seed).choice(3, SAMPLES, p=[0.6, 0.2, 0.2])
    terminated, truncated = (jnp.asarray(ends == kind, jnp.float32) for kind in (1, 2))
    reward = jax.random.normal(jax.random.key(seed + 2), SAMPLES)
    ours = Experience(
        observation=normalise(observation, normaliser),
        raw_action=raw,
        distributions=distributions,
        reward=reward,
        terminated=terminated,
        truncated=truncated,
    )
    log_prob = networks.parametric_action_distribution.log_prob(logits, raw)
    theirs = Transition(
        observation=observation,
        action=(),
        reward=reward,
        discount=1.0 - terminated,
        next_observation=last[None],
        extras={
            "policy_extras": {
                "raw_action": raw,
                "log_prob": log_prob,
                "distribution_params": logits,
            },
            "state_extras": {"truncation": truncated},
        },
    )
    return (
        ours,
        normalise(last, normaliser),
        jax.tree.map(lambda leaf: jnp.swapaxes(leaf, 0, 1), theirs),
    )


@functools.cache
def gradients_of(activation):
    """Return the configuration, and the gradient of our loss and of Brax's, compiled once."""
    config = SteeringRun(network=NetworkConfig(hidden=(24, 16), activation=activation))
    numbers = PpoParams.of(config)
    brax, mine = brax_networks(config.network), make_networks(config.network, SIGNATURE)

    def own(params, minibatch):
        return ppo_loss(params, minibatch, numbers, mine)

    def theirs(params, normaliser, transitions, key):
        return compute_ppo_loss(
            params,
            normaliser,
            transitions,
            key,
            brax,
            entropy_cost=numbers.entropy,
            discounting=numbers.discount,
            reward_scaling=numbers.reward_scale,
            gae_lambda=numbers.gae_lambda,
            clipping_epsilon=numbers.clip,
            vf_coefficient=numbers.value_weight,
        )

    both = (jax.jit(jax.value_and_grad(loss, has_aux=True)) for loss in (own, theirs))
    return config, *both


@pytest.mark.parametrize("seed", [0, 1, 2])
@pytest.mark.parametrize("activation", ["relu", "swish"])
def test_values_and_gradients_are_those_of_brax(seed, activation):
    config, own, brax = gradients_of(activation)
    normaliser = initial_normaliser(config.network, SIGNATURE)
    params = make_networks(config.network, SIGNATURE).init(*jax.random.split(jax.random.key(seed)))
    ours, last, theirs = walked(brax_networks(config.network), params, normaliser, seed)
    key = jax.random.key(9)
    noise = (jax.random.normal(key, (*SAMPLES, 4)),)
    (_, metrics), gradient = own(params, Minibatch(ours, last, noise))
    (_, expected), expected_gradient = brax(params, normaliser, theirs, key)
    assert metrics.keys() == expected.keys()
    for name, value in expected.items():
        # Brax adds 1e-5 inside the logarithm of its divergence.
        loose = 1e-3 if name == "kl_mean" else 2e-6
        np.testing.assert_allclose(metrics[name], value, rtol=2e-5, atol=loose, err_msg=name)
    for each, theirs_ in zip(
        jax.tree.leaves(gradient), jax.tree.leaves(expected_gradient), strict=True
    ):
        scale = float(jnp.max(jnp.abs(theirs_)))
        assert scale > 0.0
        np.testing.assert_allclose(each, theirs_, rtol=0, atol=2e-5 * scale)


@pytest.mark.slow
def test_products_in_bfloat16_give_nearly_the_same_gradient():
    config = SteeringRun()
    normaliser = initial_normaliser(config.network, SIGNATURE)
    networks = make_networks(config.network, SIGNATURE)
    params = networks.init(*jax.random.split(jax.random.key(0)))
    ours, last, _ = walked(brax_networks(config.network), params, normaliser, 0)
    noise = (jax.random.normal(jax.random.key(9), (*SAMPLES, 4)),)

    def gradient(products):
        network = config.network.model_copy(update={"products": products})
        networks = make_networks(network, SIGNATURE)
        rows = ours.replace(observation=ours.observation.astype(products))
        batch = Minibatch(rows, last.astype(products), noise)

        def loss(params):
            return ppo_loss(params, batch, PpoParams.of(config), networks)

        return jax.jit(jax.grad(loss, has_aux=True))(params)[0]

    exact, rough = gradient("float32"), gradient("bfloat16")
    for mine, theirs in zip(jax.tree.leaves(rough), jax.tree.leaves(exact), strict=True):
        assert mine.dtype == jnp.float32
        difference = float(jnp.linalg.norm(mine - theirs) / jnp.linalg.norm(theirs))
        # Eight bits of mantissa: off by some thousandths, and not by nothing.
        assert 1e-4 < difference < 0.05


def test_networks_answer_as_brax_networks_do():
    config = NetworkConfig()
    brax, networks = brax_networks(config), make_networks(config, SIGNATURE)
    normaliser = initial_normaliser(config, SIGNATURE)
    policy_key, value_key = jax.random.split(jax.random.key(0))
    params = networks.init(policy_key, value_key)
    theirs = brax.policy_network.init(policy_key), brax.value_network.init(value_key)
    jax.tree.map(np.testing.assert_array_equal, (params.policy, params.value), theirs)
    observation = jax.random.normal(jax.random.key(1), (5, 3, SIGNATURE.size))
    normalised = normalise(observation, normaliser)
    expected = brax.policy_network.apply(normaliser, params.policy, observation)
    for answer in (networks.answer, networks.plain):
        np.testing.assert_allclose(answer(params.policy, normalised), expected, atol=1e-5)
    values = brax.value_network.apply(normaliser, params.value, observation)
    np.testing.assert_allclose(networks.values(params.value, normalised), values, atol=1e-5)


def test_advantages_are_the_sum_over_what_was_seen():
    """By hand, sample by sample, in NumPy."""
    draw = np.random.default_rng(3)
    values, reward = draw.normal(size=(2, TIME, ROBOTS)).astype(np.float32)
    last = draw.normal(size=ROBOTS).astype(np.float32)
    ends = draw.choice(3, SAMPLES, p=[0.6, 0.2, 0.2])
    discount, decay = 0.9, 0.8
    following = np.concatenate([values[1:], last[None]])
    targets = np.zeros(SAMPLES)
    for robot in range(ROBOTS):
        for step in range(TIME):
            total, weight = 0.0, 1.0
            for later in range(step, TIME):
                if ends[later, robot] == 2:  # cut: what follows was not seen
                    break
                future = 0.0 if ends[later, robot] == 1 else discount * following[later, robot]
                total += weight * (reward[later, robot] + future - values[later, robot])
                if ends[later, robot] == 1:
                    break
                weight *= discount * decay
            targets[step, robot] = values[step, robot] + total
    hyper = SimpleNamespace(discount=discount, gae_lambda=decay, reward_scale=2.0)
    nothing: Any = None
    steps = Experience(nothing, nothing, (), 0.5 * reward, 1.0 * (ends == 1), 1.0 * (ends == 2))
    got, advantage = advantages(steps, values, last, hyper)
    np.testing.assert_allclose(got, targets, atol=1e-5)
    assert np.all(np.asarray(advantage)[ends == 2] == 0.0)
    first = reward[0] - values[0] + discount * targets[1] * (ends[0] != 1)
    np.testing.assert_allclose(
        np.asarray(advantage)[0][ends[0] != 2], first[ends[0] != 2], atol=1e-5
    )
