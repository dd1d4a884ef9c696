"""Everything a training run is, in one pytree: what a checkpoint saves and a resume restores."""

from typing import Any

import jax
import jax.numpy as jnp
import optax
from flax import struct
from jax import Array
from jaxtyping import Float, Int, Key

from jaxleas.envs.steering.env import SteeringEnv
from jaxleas.envs.steering.starts import draw_starts, take
from jaxleas.envs.steering.state import SteeringState
from jaxleas.envs.steering.world import World
from jaxleas.training.adam import BETA_1, BETA_2, EPSILON
from jaxleas.training.brax_blocks import PPONetworkParams, PPONetworks
from jaxleas.training.config import PpoConfig, RunConfig
from jaxleas.training.networks import Normaliser, initial_normaliser
from jaxleas.training.ppo_params import PpoParams
from jaxleas.types import InputError


@struct.dataclass
class TrainState:
    """The full state of a training run.

    Attributes:
        params: of actor and critic.
        averaged: exponential average of the actor's parameters: what is judged and exported.
        optimiser: Adam's moments and the learning rate's step count.
        normaliser: of observations.
        episode: of every robot.
        observation: of every robot.
        key: for everything random still to come.
        update: policy updates done.
    """

    params: Any
    averaged: Any
    optimiser: optax.OptState
    normaliser: Normaliser
    episode: SteeringState
    observation: Float[Array, "robots size"]
    key: Key[Array, ""]
    update: Int[Array, ""]


@struct.dataclass
class Learned:
    """What a run has learned, to begin another with.

    Attributes:
        params: of actor and critic.
        averaged: the averaged actor.
        normaliser: of observations.
    """

    params: Any
    averaged: Any
    normaliser: Normaliser

    @classmethod
    def of(cls, state: TrainState) -> "Learned":
        """Take it out of a state."""
        return cls(params=state.params, averaged=state.averaged, normaliser=state.normaliser)

    def into(self, state: TrainState) -> TrainState:
        """Return a fresh state with it in place of untrained networks.

        Raises:
            InputError: the networks are of other sizes.
        """
        mine = jax.tree.map(jnp.shape, (self.params, self.averaged, self.normaliser))
        theirs = jax.tree.map(jnp.shape, (state.params, state.averaged, state.normaliser))
        if jax.tree.structure(mine) != jax.tree.structure(theirs) or mine != theirs:
            raise InputError(
                "the networks to begin with are not of the sizes that this configuration asks for:"
                " network.hidden and env.observation must be the same"
            )
        return state.replace(  # type: ignore[attr-defined]
            params=self.params, averaged=self.averaged, normaliser=self.normaliser
        )


def make_optimiser(config: PpoConfig, params: PpoParams) -> optax.GradientTransformation:
    """Return Adam with a clipped gradient and a linearly falling learning rate (T sec. 3.4).

    It makes the state; `adam.descend` is its update, written out, and a test holds them together.

    Args:
        config: how many gradient steps there will be.
        params: learning rates and longest gradient, constants or traced.
    """
    # On one vector: a few operations a step instead of a few for each layer.
    return optax.flatten(
        optax.chain(
            optax.clip_by_global_norm(params.max_gradient_norm),
            optax.adam(learning_rate(config, params), b1=BETA_1, b2=BETA_2, eps=EPSILON),
        )
    )


def learning_rate(config: PpoConfig, params: PpoParams) -> optax.Schedule:
    """Return the falling learning rate, a function of the gradient steps done.

    Args:
        config: how many gradient steps there will be.
        params: the rates at start and end, constants or traced.
    """
    gradient_steps = config.updates * config.epochs * config.minibatches
    return optax.linear_schedule(params.learning_rate, params.final_learning_rate, gradient_steps)


def fresh_networks(
    networks: PPONetworks, policy_key: Key[Array, ""], value_key: Key[Array, ""]
) -> Any:
    """Return untrained parameters of actor and critic."""
    return PPONetworkParams(
        policy=networks.policy_network.init(policy_key),
        value=networks.value_network.init(value_key),
    )


def initial_state(
    config: RunConfig,
    env: SteeringEnv,
    world: World,
    networks: PPONetworks,
    seed: Int[Array, ""] | None = None,
) -> TrainState:
    """Return the state before the first update, from the run's seed alone.

    Args:
        config: of the run.
        env: the task.
        world: terrains to train on.
        networks: actor and critic.
        seed: in place of the configuration's: a population's members differ in it.
    """
    key = jax.random.key(config.seed if seed is None else seed)
    key, policy_key, value_key, pool_key, take_key, stagger_key = jax.random.split(key, 6)
    params = fresh_networks(networks, policy_key, value_key)
    count = config.ppo.environments
    pool = draw_starts(env, world, pool_key, max(count, config.ppo.candidates))
    episode, observation = take(pool, take_key, count)
    # Episodes that began at different times end at different times: no wave of resets.
    step = jax.random.randint(stagger_key, (count,), 0, config.env.episode_steps)
    return TrainState(
        params=params,
        averaged=jax.tree.map(jnp.copy, params.policy),  # a copy: buffers are donated once
        optimiser=make_optimiser(config.ppo, PpoParams.of(config)).init(params),
        normaliser=initial_normaliser(config.network, env),
        episode=episode.replace(step=step),  # type: ignore[attr-defined]
        observation=observation,
        key=key,
        update=jnp.int32(0),
    )
