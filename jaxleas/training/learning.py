"""The optimisation: passes over what was walked, a minibatch of robots at a time."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import jax
import jax.numpy as jnp
import optax
from jax import Array
from jaxtyping import Bool, Float, Int

from jaxleas.envs.steering.env import SteeringEnv
from jaxleas.envs.steering.layout import MIRROR_ACTION_SIGN
from jaxleas.training.config import RunConfig
from jaxleas.training.loss import Experience, ppo_loss
from jaxleas.training.networks import Normaliser, normalise
from jaxleas.training.ppo_params import PpoParams
from jaxleas.training.train_state import TrainState, make_optimiser


def make_learn(
    config: RunConfig, env: SteeringEnv, divide_robots: Callable[[Any], Any]
) -> Callable:
    """Return the optimisation, which returns weights, moments and metrics.

    Args:
        config: of the run.
        env: the task.
        divide_robots: lays a minibatch [time, robots, ...] out over several devices.

    Returns:
        A function of the state after walking, the normaliser, what was walked, what was seen after
        the last step, the hyperparameters and a key.
    """
    ppo = config.ppo
    robots = ppo.environments // ppo.minibatches
    steps = ppo.epochs * ppo.minibatches

    def learn(
        state: TrainState,
        normaliser: Normaliser,
        batch: Experience,
        last_observation: Array,
        numbers: PpoParams,
        key: Array,
    ):
        optimiser = make_optimiser(ppo, numbers)

        def minibatch_step(carry, inputs):
            params, moments = carry
            chosen, flip, noise = inputs
            minibatch, last = divide_robots(take_robots(env, batch, last_observation, chosen, flip))
            minibatch = replace(minibatch, observation=normalise(minibatch.observation, normaliser))
            gradient, metrics = jax.grad(ppo_loss, has_aux=True)(
                params,
                minibatch,
                normalise(last[0], normaliser),
                noise,
                numbers,
                config.network.activation,
            )
            updates, moments = optimiser.update(gradient, moments, params)
            metrics["gradient_norm"] = optax.global_norm(gradient)
            return (optax.apply_updates(params, updates), moments), metrics

        order_key, flip_key, noise_key = jax.random.split(key, 3)
        # Shuffled by robot, not by sample: sorting and gathering whole batches is slow.
        order = jax.vmap(lambda one: jax.random.permutation(one, ppo.environments))(
            jax.random.split(order_key, ppo.epochs)
        ).reshape(steps, robots)
        share = 0.5 if ppo.mirror else 0.0
        flip = jax.random.bernoulli(flip_key, share, order.shape)
        noise = jax.random.normal(noise_key, (steps, ppo.unroll, robots, env.action_size))
        (params, moments), metrics = jax.lax.scan(
            minibatch_step, (state.params, state.optimiser), (order, flip, noise)
        )
        averages = {f"learn/{name}": jnp.mean(value) for name, value in metrics.items()}
        return params, moments, averages

    return learn


def take_robots(
    env: SteeringEnv,
    batch: Experience,
    last_observation: Float[Array, "robots size"],
    chosen: Int[Array, " some"],
    flip: Bool[Array, " some"],
) -> tuple[Experience, Float[Array, "1 some size"]]:
    """Return some of the robots, with left and right swapped for some of these.

    The task is symmetric, so a mirrored step is as good as a walked one; its probability under the
    old policy is taken to be the original's, exact once the policy is symmetric.

    Args:
        env: the task.
        batch: of all robots.
        last_observation: of all robots, after the last step.
        chosen: the robots to take.
        flip: which of them are mirrored.

    Returns:
        What they walked, and what they see in the end with an axis of time, too: of one step.
    """
    mirrored = jnp.asarray(env.layout.mirror_permutation, jnp.int32)
    column = jnp.where(flip[:, None], mirrored[None], jnp.arange(env.layout.size)[None])
    sign = jnp.where(flip[:, None], jnp.asarray(env.layout.mirror_sign)[None], 1.0)[None]
    action_sign = jnp.where(flip[:, None], jnp.asarray(MIRROR_ACTION_SIGN)[None], 1.0)[None]

    def observed(whole: Array) -> Array:
        # Robots and columns in one gather: a second pass over the rows costs as much again.
        found = whole.at[:, chosen[:, None], column].get(mode="promise_in_bounds")
        return found * sign

    taken = jax.tree.map(
        lambda leaf: leaf.at[:, chosen].get(mode="promise_in_bounds"),
        replace(batch, observation=batch.reward),
    )
    some = replace(
        taken,
        observation=observed(batch.observation),
        raw_action=taken.raw_action * action_sign,
        location=taken.location * action_sign,
    )
    return some, observed(last_observation[None])
