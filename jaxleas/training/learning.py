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
    ppo, network = config.ppo, config.network
    robots = ppo.environments // ppo.minibatches
    steps = ppo.epochs * ppo.minibatches

    def seen(observation: Array, normaliser: Normaliser) -> Array:
        return normalise(observation, normaliser).astype(network.products)

    def learn(
        state: TrainState,
        normaliser: Normaliser,
        batch: Experience,
        last_observation: Array,
        numbers: PpoParams,
        key: Array,
    ):
        optimiser = make_optimiser(ppo, numbers)
        images, last = mirror_images(env, batch, last_observation, ppo.mirror)
        images = replace(images, observation=seen(images.observation, normaliser))
        last = seen(last, normaliser)

        def minibatch_step(carry, inputs):
            params, moments = carry
            chosen, flip, noise = inputs
            minibatch, seen_last = divide_robots(take_robots(images, last, chosen, flip))
            gradient, metrics = jax.grad(ppo_loss, has_aux=True)(
                params,
                minibatch,
                seen_last[0],
                noise,
                numbers,
                network,
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


def mirror_images(
    env: SteeringEnv,
    batch: Experience,
    last_observation: Float[Array, "robots size"],
    mirror: bool = True,
) -> tuple[Experience, Float[Array, "1 images robots size"]]:
    """Return what was walked and its mirror image, left and right swapped.

    The task is symmetric, so a mirrored step is as good as a walked one; its probability under the
    old policy is taken to be the original's, exact once the policy is symmetric. Mirrored once an
    update: a minibatch then takes whole rows. It takes them twice, as XLA:CPU computes them anew
    where they are needed turned round, so it must be cheap.

    Args:
        env: the task.
        batch: of all robots.
        last_observation: of all robots, after the last step.
        mirror: whether there is to be an image.

    Returns:
        The batch [time, images, robots, ...], as walked and then mirrored, and what the robots see
        in the end with an axis of time, too: of one step.
    """
    if not mirror:
        return jax.tree.map(lambda leaf: leaf[:, None], (batch, last_observation[None]))
    order = jnp.asarray(env.layout.mirror_permutation, jnp.int32)
    sign = jnp.asarray(env.layout.mirror_sign).reshape(1, 1, -1)
    action_sign = jnp.asarray(MIRROR_ACTION_SIGN).reshape(1, 1, -1)

    def seen(whole: Array) -> Array:
        return jnp.stack([whole, whole.at[..., order].get(mode="promise_in_bounds") * sign], axis=1)

    def done(action: Array) -> Array:
        return jnp.stack([action, action * action_sign], axis=1)

    twice = jax.tree.map(
        lambda leaf: jnp.stack([leaf, leaf], axis=1), replace(batch, observation=batch.reward)
    )
    images = replace(
        twice,
        observation=seen(batch.observation),
        raw_action=done(batch.raw_action),
        location=done(batch.location),
    )
    return images, seen(last_observation[None])


def take_robots(
    images: Experience,
    last_observation: Float[Array, "1 images robots size"],
    chosen: Int[Array, " some"],
    flip: Bool[Array, " some"],
) -> tuple[Experience, Float[Array, "1 some size"]]:
    """Return some of the robots, mirrored or as they walked.

    Args:
        images: of the batch.
        last_observation: of all robots, after the last step, likewise.
        chosen: the robots to take.
        flip: which of them are mirrored.
    """
    which = flip.astype(jnp.int32)
    return jax.tree.map(
        lambda leaf: leaf.at[:, which, chosen].get(mode="promise_in_bounds"),
        (images, last_observation),
    )
