"""Our PPO loss is Brax's: values and gradients, over batches with ends of every kind."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from jaxleas.envs.steering import SteeringConfig, SteeringEnv
from jaxleas.training.brax_blocks import Transition, compute_ppo_loss
from jaxleas.training.config import NetworkConfig, RunConfig
from jaxleas.training.loss import Experience, action_distribution, advantages, ppo_loss
from jaxleas.training.networks import dense, initial_normaliser, make_networks, normalise
from jaxleas.training.ppo_params import PpoParams
from jaxleas.training.train_state import fresh_networks

pytestmark = pytest.mark.usefixtures("brax_ranks")

TIME, ROBOTS = 7, 12
SAMPLES = (TIME, ROBOTS)


def walked(env, networks, params, normaliser, seed):
    """Return a batch, walked by a policy a little other than `params`, in both forms."""
    keys = jax.random.split(jax.random.key(seed), 3)
    observation, last = (
        jax.random.uniform(key, (*shape, env.layout.size), minval=-1.0)
        for key, shape in zip(keys, (SAMPLES, (ROBOTS,)), strict=False)
    )
    walker = jax.tree.map(
        lambda leaf: 1.1 * leaf + 0.02 * jax.random.normal(keys[2], leaf.shape), params.policy
    )
    logits = networks.policy_network.apply(normaliser, walker, observation)
    location, deviation = action_distribution(logits)
    raw = location + deviation * jax.random.normal(jax.random.key(seed + 1), location.shape)
    ends = np.random.default_rng(seed).choice(3, SAMPLES, p=[0.6, 0.2, 0.2])
    terminated, truncated = (jnp.asarray(ends == kind, jnp.float32) for kind in (1, 2))
    reward = jax.random.normal(jax.random.key(seed + 2), SAMPLES)
    ours = Experience(
        observation=normalise(observation, normaliser),
        raw_action=raw,
        location=location,
        deviation=deviation,
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


@pytest.mark.parametrize("seed", [0, 1, 2])
@pytest.mark.parametrize("activation", ["relu", "swish"])
def test_values_and_gradients_are_those_of_brax(seed, activation):
    config = RunConfig(
        network=NetworkConfig(hidden=(24, 16), activation=activation),
    )
    numbers = PpoParams.of(config)
    env = SteeringEnv(SteeringConfig())
    networks = make_networks(config.network, env)
    normaliser = initial_normaliser(config.network, env)
    params = fresh_networks(networks, *jax.random.split(jax.random.key(seed)))
    ours, last, theirs = walked(env, networks, params, normaliser, seed)
    key = jax.random.key(9)
    noise = jax.random.normal(key, (*SAMPLES, 4))

    def brax(params):
        return compute_ppo_loss(
            params,
            normaliser,
            theirs,
            key,
            networks,
            entropy_cost=numbers.entropy,
            discounting=numbers.discount,
            reward_scaling=numbers.reward_scale,
            gae_lambda=numbers.gae_lambda,
            clipping_epsilon=numbers.clip,
            vf_coefficient=numbers.value_weight,
        )

    (_, metrics), gradient = jax.value_and_grad(ppo_loss, has_aux=True)(
        params, ours, last, noise, numbers, config.network
    )
    (_, expected), expected_gradient = jax.value_and_grad(brax, has_aux=True)(params)
    assert metrics.keys() == expected.keys()
    for name, value in expected.items():
        # Brax adds 1e-5 inside the logarithm of its divergence.
        loose = 1e-3 if name == "kl_mean" else 2e-6
        np.testing.assert_allclose(metrics[name], value, rtol=2e-5, atol=loose, err_msg=name)
    for mine, theirs_ in zip(
        jax.tree.leaves(gradient), jax.tree.leaves(expected_gradient), strict=True
    ):
        scale = float(jnp.max(jnp.abs(theirs_)))
        assert scale > 0.0
        np.testing.assert_allclose(mine, theirs_, rtol=0, atol=2e-5 * scale)


def test_products_in_bfloat16_give_nearly_the_same_gradient():
    env = SteeringEnv(SteeringConfig())
    config = RunConfig()
    networks = make_networks(config.network, env)
    normaliser = initial_normaliser(config.network, env)
    params = fresh_networks(networks, *jax.random.split(jax.random.key(0)))
    ours, last, _ = walked(env, networks, params, normaliser, 0)
    noise = jax.random.normal(jax.random.key(9), (*SAMPLES, 4))

    def gradient(products):
        network = config.network.model_copy(update={"products": products})
        rows = ours.replace(observation=ours.observation.astype(products))
        return jax.grad(ppo_loss, has_aux=True)(
            params, rows, last.astype(products), noise, PpoParams.of(config), network
        )[0]

    exact, rough = gradient("float32"), gradient("bfloat16")
    for mine, theirs in zip(jax.tree.leaves(rough), jax.tree.leaves(exact), strict=True):
        assert mine.dtype == jnp.float32
        difference = float(jnp.linalg.norm(mine - theirs) / jnp.linalg.norm(theirs))
        # Eight bits of mantissa: off by some thousandths, and not by nothing.
        assert 1e-4 < difference < 0.05


def test_networks_answer_as_brax_networks_do():
    config = NetworkConfig()
    env = SteeringEnv(SteeringConfig())
    networks = make_networks(config, env)
    normaliser = initial_normaliser(config, env)
    params = fresh_networks(networks, *jax.random.split(jax.random.key(0)))
    observation = jax.random.normal(jax.random.key(1), (5, 3, env.layout.size))
    normalised = normalise(observation, normaliser)
    for network, weights in ((networks.policy_network, params.policy),):
        np.testing.assert_allclose(
            dense(weights, normalised, config),
            network.apply(normaliser, weights, observation),
            atol=1e-5,
        )


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
    got, advantage = advantages(values, last, reward, ends == 1, 1.0 * (ends == 2), discount, decay)
    np.testing.assert_allclose(got, targets, atol=1e-5)
    assert np.all(np.asarray(advantage)[ends == 2] == 0.0)
    first = reward[0] - values[0] + discount * targets[1] * (ends[0] != 1)
    np.testing.assert_allclose(
        np.asarray(advantage)[0][ends[0] != 2], first[ends[0] != 2], atol=1e-5
    )
