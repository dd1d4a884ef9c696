"""Proximal policy optimisation as one train step: walk, learn, average."""

from collections.abc import Callable
from typing import Any, Protocol

import jax
import jax.numpy as jnp
from jax import Array

from jaxleas.envs import Task
from jaxleas.training.config import RunConfig
from jaxleas.training.devices import Devices
from jaxleas.training.learning import make_learn
from jaxleas.training.loss import Experience
from jaxleas.training.networks import ActorCritic
from jaxleas.training.normaliser import update_normaliser
from jaxleas.training.ppo_params import PpoParams
from jaxleas.training.train_state import TrainState
from jaxleas.training.walkers import HostWalker, make_walk

Metrics = dict[str, Array]


class TrainStep(Protocol):
    """Draws fresh starts, walks and learns, once."""

    def __call__(
        self, world: Any, state: TrainState, params: PpoParams | None = None
    ) -> tuple[TrainState, Metrics]:
        """Return the state after one update, and the metrics of that update.

        Args:
            world: world that the robots train in.
            state: state before the update.
            params: hyperparameters; None: those of the configuration, as constants of the program.
        """
        ...


def make_train_step(
    config: RunConfig, task: Task, networks: ActorCritic, devices: Devices | None = None
) -> TrainStep:
    """Return the train step of a task that steps on the device. It is pure; jit it as you like.

    Args:
        config: configuration of the run.
        task: task that steps on the device.
        networks: actor and critic.
        devices: devices that share the learning; None: one.

    Returns:
        The train step, whose result depends on its arguments alone.
    """
    walk = make_walk(config, task, networks)
    update = make_update(config, networks, devices)
    constants = PpoParams.of(config)

    def train_step(
        world: Any, state: TrainState, params: PpoParams | None = None
    ) -> tuple[TrainState, Metrics]:
        numbers = constants if params is None else params
        key, walk_key, learn_key = jax.random.split(state.key, 3)
        state, batch, walked = walk(world, state, numbers, walk_key)
        state, learned = update(state, batch, state.observation, learn_key, numbers)
        return state.replace(key=key), walked | learned  # type: ignore[attr-defined]

    return train_step


class HostTrainStep:
    """The train step of a task that steps on the host: only its two halves are compiled.

    Args:
        config: configuration of the run.
        task: task that steps on the host.
        networks: actor and critic.
        devices: devices that share the learning; None: one.
    """

    def __init__(
        self, config: RunConfig, task: Task, networks: ActorCritic, devices: Devices | None = None
    ) -> None:
        self._walk = HostWalker(config, task, networks)
        self._update = jax.jit(make_update(config, networks, devices), donate_argnums=0)
        self._constants = PpoParams.of(config)

    def __call__(
        self, world: Any, state: TrainState, params: PpoParams | None = None
    ) -> tuple[TrainState, Metrics]:
        """Return the state after one update, and the metrics of that update."""
        numbers = self._constants if params is None else params
        key, walk_key, learn_key = jax.random.split(state.key, 3)
        state, batch, walked = self._walk(world, state, numbers, walk_key)
        episode, observation = state.episode, state.observation
        learner = state.replace(episode=(), observation=())  # type: ignore[attr-defined]
        learner, learned = self._update(learner, batch, observation, learn_key, numbers)
        state = learner.replace(episode=episode, observation=observation, key=key)
        return state, walked | learned


def make_update(
    config: RunConfig, networks: ActorCritic, devices: Devices | None = None
) -> Callable[..., tuple[TrainState, Metrics]]:
    """Return the second half of the train step: learn from a batch, however it was walked.

    The ratios of the loss are against the policy that walked, whose distributions are in the
    batch: it need not be the present one.

    Args:
        config: configuration of the run.
        networks: actor and critic.
        devices: devices that share the learning; None: one.

    Returns:
        A function (state, batch [time, robots], observation after its last step, key,
        hyperparameters) -> (state after one update, metrics); without hyperparameters it uses
        those of the configuration.
    """
    learn = make_learn(config, networks, devices)
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
    """Return the exponential average of the actor; early in training, over fewer updates."""
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
