"""The optimisation: passes over the experience, one minibatch of robots at a time."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import jax
import jax.numpy as jnp
import optax
from jax import Array
from jax.flatten_util import ravel_pytree

from jaxleas.training.averages import Average
from jaxleas.training.config import RunConfig
from jaxleas.training.devices import AXIS, Devices
from jaxleas.training.loss import LARGEST, SMALLEST, Experience, Minibatch, ppo_loss
from jaxleas.training.minibatches import Draws, draw_minibatches, mirror_images, take_robots
from jaxleas.training.networks import ActorCritic
from jaxleas.training.normaliser import Normaliser, normalise
from jaxleas.training.optimiser import learning_rate
from jaxleas.training.ppo_params import PpoParams
from jaxleas.training.train_state import TrainState
from jaxleas.xla import descend


def make_learn(
    config: RunConfig, networks: ActorCritic, devices: Devices | None = None
) -> Callable:
    """Return the optimisation, which returns weights, moments and metrics.

    Args:
        config: configuration of the run.
        networks: actor and critic.
        devices: devices that share it: each learns from its own robots; gradients are averaged.

    Returns:
        A function of the state after walking, the normaliser, the experience, the observation
        after the last step, the hyperparameters and a key.
    """
    ppo, signature = config.ppo, networks.signature
    mirror = ppo.mirror and signature.symmetric
    share = None if devices is None or len(devices) == 1 else devices.share

    def seen(observation: Array, normaliser: Normaliser) -> Array:
        return normalise(observation, normaliser).astype(networks.numbers)

    def learn(
        state: TrainState,
        normaliser: Normaliser,
        batch: Experience,
        last_observation: Array,
        numbers: PpoParams,
        key: Array,
    ):
        rate = learning_rate(ppo, numbers)
        average = Average(AXIS if share else None)

        def descend_all(params, moments, normaliser, walked, draws):
            images, last = mirror_images(signature, *walked, mirror=mirror)
            images = replace(images, observation=seen(images.observation, normaliser))
            last = seen(last, normaliser)
            first = jnp.arange(draws.order.shape[1]) * ppo.minibatches

            def minibatch_step(carry, drawn):
                params, moments = carry
                steps, seen_last = take_robots(images, last, first + drawn.order, drawn.flip)
                minibatch = Minibatch(steps, seen_last[0], drawn.noise)
                gradient, metrics = jax.grad(ppo_loss, has_aux=True)(
                    params, minibatch, numbers, networks, average
                )
                vector, as_params = ravel_pytree(gradient)
                change, moments, metrics["gradient_norm"] = descend(
                    average.mean(vector), moments, rate, numbers.max_gradient_norm
                )
                return (optax.apply_updates(params, as_params(change)), moments), metrics

            (params, moments), metrics = jax.lax.scan(minibatch_step, (params, moments), draws)
            return params, moments, average.metrics(metrics, LARGEST, SMALLEST)

        draws = draw_minibatches(ppo, signature.heads, mirror, key)
        along: Any = {"order": 1, "flip": 1, "noise": 2}
        robot_axes = (None, None, None, (1, 0), Draws(**along))
        together = share(descend_all, robot_axes) if share else descend_all
        params, moments, metrics = together(
            state.params, state.optimiser, normaliser, (batch, last_observation), draws
        )
        averages = {f"learn/{name}": jnp.mean(value) for name, value in metrics.items()}
        return params, moments, averages

    return learn
