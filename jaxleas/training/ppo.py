"""Proximal policy optimisation as one jitted train step: walk, learn, average."""

from collections.abc import Callable
from typing import Any, Protocol

import jax
import jax.numpy as jnp
from jax import Array

from jaxleas.envs.steering.env import SteeringEnv
from jaxleas.envs.steering.world import World
from jaxleas.training.config import RunConfig
from jaxleas.training.devices import Devices
from jaxleas.training.learning import make_learn
from jaxleas.training.loss import Experience
from jaxleas.training.networks import update_normaliser
from jaxleas.training.ppo_params import PpoParams
from jaxleas.training.train_state import TrainState
from jaxleas.training.walking import make_walk

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
    devices: Devices | None = None,
) -> TrainStep:
    """Return the train step: draw fresh starts, walk, learn. It is pure; jit it as you like.

    Args:
        config: of the run.
        env: the task.
        devices: that share the learning; None: one.

    Returns:
        The train step, on whose arguments alone what it returns depends.
    """
    walk = make_walk(config, env)
    update = make_update(config, env, devices)
    constants = PpoParams.of(config)

    def train_step(
        world: World, state: TrainState, params: PpoParams | None = None
    ) -> tuple[TrainState, Metrics]:
        numbers = constants if params is None else params
        key, walk_key, learn_key = jax.random.split(state.key, 3)
        state, batch, walked = walk(world, state, numbers, walk_key)
        state, learned = update(state, batch, state.observation, learn_key, numbers)
        return state.replace(key=key), walked | learned  # type: ignore[attr-defined]

    return train_step


def make_update(
    config: RunConfig,
    env: SteeringEnv,
    devices: Devices | None = None,
) -> Callable[..., tuple[TrainState, Metrics]]:
    """Return the second half of the train step: learn from a batch, whoever walked it.

    The ratios of the loss are against the policy that walked, whose distributions are in the
    batch: it need not be the present one.

    Args:
        config: of the run.
        env: the task.
        devices: that share the learning; None: one.

    Returns:
        A function (state, batch [time, robots], observation after its last step, key,
        hyperparameters) -> (state after one update, metrics); without hyperparameters the
        configuration's.
    """
    learn = make_learn(config, env, devices)
    constants = PpoParams.of(config)

    def update(
        state: TrainState,
        batch: Experience,
        last_observation: Array,
        key: Array,
        numbers: PpoParams = constants,
    ) -> tuple[TrainState, Metrics]:
        normaliser = update_normaliser(state.normaliser, batch.observation)
        weights, optimiser, learned = learn(
            state, normaliser, batch, last_observation, numbers, key
        )
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


def _all_finite(tree: Any) -> Array:
    leaves = [
        jnp.all(jnp.isfinite(leaf))
        for leaf in jax.tree.leaves(tree)
        if jnp.issubdtype(leaf.dtype, jnp.inexact)
    ]
    return jnp.all(jnp.stack(leaves))
