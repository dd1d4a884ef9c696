"""Proximal policy optimisation over Brax's networks and loss, as one jitted train step."""

from collections.abc import Callable
from typing import Any, Protocol

import jax
import jax.numpy as jnp
import optax
from jax import Array

from jaxleas.envs.steering.env import SteeringEnv
from jaxleas.envs.steering.layout import MIRROR_ACTION_SIGN
from jaxleas.envs.steering.starts import draw_starts, restart_where
from jaxleas.envs.steering.world import World
from jaxleas.training.brax_blocks import PPONetworks, Transition, compute_ppo_loss
from jaxleas.training.config import RunConfig
from jaxleas.training.networks import update_normaliser
from jaxleas.training.ppo_params import PpoParams
from jaxleas.training.train_state import TrainState, make_optimiser

Metrics = dict[str, Array]


class TrainStep(Protocol):
    """Draws fresh starts, walks and learns, once; pure."""

    def __call__(
        self, world: World, state: TrainState, params: PpoParams | None = None
    ) -> tuple[TrainState, Metrics]:
        """Return the state after one update, and the metrics of that update.

        Args:
            world: terrains to train on.
            state: before the update.
            params: hyperparameters; None: the configuration's, as constants of the program.
        """
        ...


def make_train_step(
    config: RunConfig,
    env: SteeringEnv,
    networks: PPONetworks,
    divide_robots: Callable[[Any], Any] = lambda minibatch: minibatch,
) -> TrainStep:
    """Return the train step: draw fresh starts, walk, learn. It is pure; jit it as you like.

    Args:
        config: of the run.
        env: the task.
        networks: actor and critic.
        divide_robots: lays a minibatch [time, robots, ...] out over several devices.

    Returns:
        The train step, on whose arguments alone what it returns depends.
    """
    walk = _make_walk(config, env, networks)
    update = make_update(config, env, networks, divide_robots)
    constants = PpoParams.of(config)

    def train_step(
        world: World, state: TrainState, params: PpoParams | None = None
    ) -> tuple[TrainState, Metrics]:
        numbers = constants if params is None else params
        key, walk_key, learn_key = jax.random.split(state.key, 3)
        state, batch, walked = walk(world, state, numbers, walk_key)
        state, learned = update(state, batch, learn_key, numbers)
        return state.replace(key=key), walked | learned  # type: ignore[attr-defined]

    return train_step


def make_update(
    config: RunConfig,
    env: SteeringEnv,
    networks: PPONetworks,
    divide_robots: Callable[[Any], Any] = lambda minibatch: minibatch,
) -> Callable[..., tuple[TrainState, Metrics]]:
    """Return the second half of the train step: learn from a batch, whoever walked it.

    The ratios of the loss are against the policy that walked, whose log-probabilities are in the
    batch: it need not be the present one.

    Args:
        config: of the run.
        env: the task.
        networks: actor and critic.
        divide_robots: lays a minibatch [time, robots, ...] out over several devices.

    Returns:
        A function (state, batch [time, robots], key, hyperparameters) -> (state after one update,
        metrics); without hyperparameters the configuration's.
    """
    learn = _make_learn(config, env, networks, divide_robots)
    constants = PpoParams.of(config)

    def update(
        state: TrainState, batch: Any, key: Array, numbers: PpoParams = constants
    ) -> tuple[TrainState, Metrics]:
        normaliser = update_normaliser(state.normaliser, batch.observation)
        weights, optimiser, learned = learn(state, normaliser, batch, numbers, key)
        averaged = _average(config.ppo.averaging, state, weights)
        state = state.replace(  # type: ignore[attr-defined]
            params=weights,
            averaged=averaged,
            optimiser=optimiser,
            normaliser=normaliser,
            update=state.update + 1,
        )
        finite = {
            "finite/observation": _all_finite(batch.observation),
            "finite/reward": _all_finite(batch.reward),
            "finite/loss": _all_finite(learned),
            "finite/parameters": _all_finite((weights, optimiser)),
        }
        return state, learned | finite

    return update


def _average(decay: float, state: TrainState, params: Any) -> Any:
    """Return the exponential average of the actor, over fewer updates while there are few."""
    count = state.update.astype(jnp.float32) + 1.0
    decay_now = jnp.minimum(decay, count / (count + 10.0))
    return jax.tree.map(
        lambda average, now: decay_now * average + (1.0 - decay_now) * now,
        state.averaged,
        params.policy,
    )


def _make_walk(config: RunConfig, env: SteeringEnv, networks: PPONetworks) -> Callable:
    """Return the roll-out: every robot takes `unroll` steps with the present policy."""
    ppo = config.ppo
    distribution = networks.parametric_action_distribution

    def walk(world: World, state: TrainState, numbers: PpoParams, key: Array):
        pool_key, noise_key, restart_key = jax.random.split(key, 3)
        progress = state.update.astype(jnp.float32) / ppo.updates
        weights = numbers.reward_weights(progress)
        pool = draw_starts(env, world, pool_key, ppo.candidates)
        restart_keys = jax.random.split(restart_key, ppo.unroll)
        # All exploration noise in one draw: one random key a batch, not one a robot.
        noise = jax.random.normal(noise_key, (ppo.unroll, ppo.environments, env.action_size))

        def advance(carry, inputs):
            episode, observation = carry
            noise_now, key_now = inputs
            logits = networks.policy_network.apply(
                state.normaliser, state.params.policy, observation
            )
            normal: Any = distribution.create_dist(logits)
            raw_action = normal.loc + normal.scale * noise_now
            action = distribution.postprocess(raw_action)
            after, outcome = env.step(world.atlas, weights, episode, action)
            done = outcome.terminated | outcome.truncated
            carry = restart_where(done, after, outcome.observation, pool, key_now)
            record = Transition(
                observation=observation,
                action=(),
                reward=outcome.reward,
                discount=1.0 - outcome.terminated.astype(jnp.float32),
                next_observation=(),
                extras={
                    "policy_extras": {
                        "raw_action": raw_action,
                        "log_prob": distribution.log_prob(logits, raw_action),
                        "distribution_params": logits,
                    },
                    "state_extras": {"truncation": outcome.truncated.astype(jnp.float32)},
                },
            )
            counts = jnp.stack(
                [jnp.sum(flag) for flag in (outcome.terminated, outcome.truncated, outcome.reached)]
            )
            return carry, (record, counts)

        (episode, observation), (batch, counts) = jax.lax.scan(
            advance, (state.episode, state.observation), (noise, restart_keys)
        )
        # The loss asks only for the observation after the last step, to bootstrap from.
        batch = batch._replace(next_observation=observation[None])
        failed, cut, reached = jnp.sum(counts, axis=0).astype(jnp.float32)
        metrics = {
            "walk/reward": jnp.mean(batch.reward),
            "walk/failures_per_1000_steps": 1000.0 * failed / ppo.batch,
            "walk/goals_per_1000_steps": 1000.0 * reached / ppo.batch,
            "walk/valid_starts": pool.valid_count / ppo.candidates,
            "walk/episodes": failed + cut,
        }
        state = state.replace(episode=episode, observation=observation)  # type: ignore[attr-defined]
        return state, batch, metrics

    return walk


def _make_learn(
    config: RunConfig, env: SteeringEnv, networks: PPONetworks, divide_robots: Callable[[Any], Any]
) -> Callable:
    """Return the optimisation: `epochs` passes over the batch, a minibatch at a time."""
    ppo = config.ppo
    robots = ppo.environments // ppo.minibatches

    def loss(params, normaliser, minibatch, numbers, key):
        return compute_ppo_loss(
            params,
            normaliser,
            minibatch,
            key,
            networks,
            entropy_cost=numbers.entropy,
            discounting=numbers.discount,
            reward_scaling=numbers.reward_scale,
            gae_lambda=numbers.gae_lambda,
            clipping_epsilon=numbers.clip,
            vf_coefficient=numbers.value_weight,
        )

    def learn(state: TrainState, normaliser, batch: Any, numbers: PpoParams, key: Array):
        optimiser = make_optimiser(ppo, numbers)

        def minibatch_step(carry, inputs):
            params, moments = carry
            chosen, minibatch_key = inputs
            mirror_key, entropy_key = jax.random.split(minibatch_key)
            minibatch = divide_robots(jax.tree.map(lambda leaf: leaf[:, chosen], batch))
            if ppo.mirror:
                minibatch = _mirror_half(env, minibatch, mirror_key)
            # Brax's loss wants [robots, time].
            minibatch = jax.tree.map(lambda leaf: jnp.swapaxes(leaf, 0, 1), minibatch)
            gradient, metrics = jax.grad(loss, has_aux=True)(
                params, normaliser, minibatch, numbers, entropy_key
            )
            updates, moments = optimiser.update(gradient, moments, params)
            metrics["gradient_norm"] = optax.global_norm(gradient)
            return (optax.apply_updates(params, updates), moments), metrics

        order_key, minibatch_key = jax.random.split(key)
        # Shuffled by robot, not by sample: sorting and gathering whole batches is slow.
        order = jax.vmap(lambda one: jax.random.permutation(one, ppo.environments))(
            jax.random.split(order_key, ppo.epochs)
        ).reshape(ppo.epochs * ppo.minibatches, robots)
        keys = jax.random.split(minibatch_key, len(order))
        (params, moments), metrics = jax.lax.scan(
            minibatch_step, (state.params, state.optimiser), (order, keys)
        )
        averages = {f"learn/{name}": jnp.mean(value) for name, value in metrics.items()}
        return params, moments, averages

    return learn


def _mirror_half(env: SteeringEnv, batch: Any, key: Array) -> Any:
    """Swap left and right for a random half of the robots in a minibatch [time, robots].

    The task is symmetric, so a mirrored step is as good as a walked one; its log-probability under
    the old policy is taken to be the original's, exact once the policy is symmetric.
    """
    flip = jax.random.bernoulli(key, 0.5, (batch.reward.shape[1],))[None, :, None]
    permutation = env.layout.mirror_permutation
    sign = jnp.asarray(env.layout.mirror_sign)[None, None]
    action_sign = jnp.asarray(MIRROR_ACTION_SIGN)[None, None]

    def mirrored(observation: Array) -> Array:
        return jnp.where(flip, observation[..., permutation] * sign, observation)

    extras = batch.extras["policy_extras"]
    raw = extras["raw_action"]
    logits = extras["distribution_params"]
    logit_sign = jnp.concatenate([action_sign, jnp.ones_like(action_sign)], axis=-1)
    return batch._replace(
        observation=mirrored(batch.observation),
        next_observation=mirrored(batch.next_observation),
        extras={
            **batch.extras,
            "policy_extras": {
                **extras,
                "raw_action": jnp.where(flip, raw * action_sign, raw),
                "distribution_params": jnp.where(flip, logits * logit_sign, logits),
            },
        },
    )


def _all_finite(tree: Any) -> Array:
    leaves = [
        jnp.all(jnp.isfinite(leaf))
        for leaf in jax.tree.leaves(tree)
        if jnp.issubdtype(leaf.dtype, jnp.inexact)
    ]
    return jnp.all(jnp.stack(leaves))
