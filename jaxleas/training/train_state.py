"""The whole state of a training run in one pytree, which checkpoints save and resuming restores."""

from typing import Any

import jax
import jax.numpy as jnp
import optax
from flax import struct
from jax import Array
from jaxtyping import Float, Int, Key

from jaxleas.envs import HostPool, Signature, Task, pool_of, take
from jaxleas.training.config import PpoConfig, RunConfig
from jaxleas.training.networks import ActorCritic
from jaxleas.training.normaliser import Normaliser, initial_normaliser
from jaxleas.training.ppo_params import PpoParams
from jaxleas.types import InputError
from jaxleas.xla import BETA_1, BETA_2, EPSILON


@struct.dataclass
class TrainState:
    """The full state of a training run.

    Attributes:
        params: parameters of actor and critic.
        averaged: exponential average of the actor's parameters: what is judged and exported.
        optimiser: Adam's moments and the learning rate's step count.
        normaliser: normaliser of observations.
        episode: state of every robot's episode, as the task defines it.
        observation: observation of every robot, one vector each.
        key: randomness of everything still to come.
        update: number of policy updates done.
    """

    params: Any
    averaged: Any
    optimiser: optax.OptState
    normaliser: Normaliser
    episode: Any
    observation: Float[Array, "robots size"]
    key: Key[Array, ""]
    update: Int[Array, ""]


@struct.dataclass
class Learned:
    """The learned networks of a run, from which another run can begin.

    Attributes:
        params: parameters of actor and critic.
        averaged: averaged parameters of the actor.
        normaliser: normaliser of observations.
    """

    params: Any
    averaged: Any
    normaliser: Normaliser

    @classmethod
    def of(cls, state: TrainState) -> "Learned":
        """Return what the run with this state has learned."""
        return cls(params=state.params, averaged=state.averaged, normaliser=state.normaliser)

    def into(self, state: TrainState) -> TrainState:
        """Return a fresh state with these networks in place of untrained ones.

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

    It makes the state; `adam.descend` is its update, written out, and a test compares the two.

    Args:
        config: configuration of PPO, which gives the number of gradient steps.
        params: hyperparameters: learning rates and gradient norm, constants or traced.
    """
    # On one vector: a few operations per step instead of a few per layer.
    return optax.flatten(
        optax.chain(
            optax.clip_by_global_norm(params.max_gradient_norm),
            optax.adam(learning_rate(config, params), b1=BETA_1, b2=BETA_2, eps=EPSILON),
        )
    )


def learning_rate(config: PpoConfig, params: PpoParams) -> optax.Schedule:
    """Return the falling learning rate, a function of the gradient steps done.

    Args:
        config: configuration of PPO, which gives the number of gradient steps.
        params: hyperparameters: learning rates at start and end, constants or traced.
    """
    gradient_steps = config.updates * config.epochs * config.minibatches
    return optax.linear_schedule(params.learning_rate, params.final_learning_rate, gradient_steps)


@struct.dataclass
class FirstKeys:
    """Randomness of a run's first state; each is consumed once.

    Attributes:
        rest: key for everything after the first state.
        policy: key for the actor's parameters.
        value: key for the critic's parameters.
        pool: key for the candidates for first states.
        take: key for the choice among them.
        stagger: key for the times at which episodes began.
    """

    rest: Key[Array, ""]
    policy: Key[Array, ""]
    value: Key[Array, ""]
    pool: Key[Array, ""]
    take: Key[Array, ""]
    stagger: Key[Array, ""]

    @classmethod
    def of(cls, seed: Any) -> "FirstKeys":
        """Return the keys of a training seed."""
        return cls(*jax.random.split(jax.random.key(seed), 6))


def initial_state(
    config: RunConfig,
    task: Task,
    world: Any,
    networks: ActorCritic,
    seed: Int[Array, ""] | None = None,
) -> TrainState:
    """Return the state before the first update, from the run's seed alone.

    Args:
        config: configuration of the run.
        task: task that steps on the device.
        world: world that the robots train in.
        networks: actor and critic.
        seed: training seed in place of the configuration's; members of a population differ in it.
    """
    keys = FirstKeys.of(config.seed if seed is None else seed)
    count = config.ppo.environments
    starts = task.draw_starts(world, keys.pool, max(count, config.ppo.candidates))
    episode, _ = take(pool_of(starts), keys.take, count)
    observation = task.signature.pack(task.look(world, episode))
    # Episodes that began at different times end at different times: no wave of resets.
    episode = task.stagger(episode, keys.stagger)
    return _state(config, task.signature, networks, keys, episode, observation)


def initial_host_state(
    config: RunConfig, task: Task, world: Any, networks: ActorCritic
) -> TrainState:
    """Return the state before the first update of a task that steps on the host."""
    from jaxleas.training.walkers.host import generator_of, look

    keys = FirstKeys.of(config.seed)
    count = config.ppo.environments
    starts = task.draw_starts(world, generator_of(keys.pool), max(count, config.ppo.candidates))
    pool = HostPool.of(starts)
    episode, _ = pool.take(pool.draw_picks(generator_of(keys.take), (count,)))
    episode = task.stagger(episode, generator_of(keys.stagger))
    return _state(config, task.signature, networks, keys, episode, look(task, world, episode))


def _state(
    config: RunConfig,
    signature: Signature,
    networks: ActorCritic,
    keys: FirstKeys,
    episode: Any,
    observation: Any,
) -> TrainState:
    params = networks.init(keys.policy, keys.value)
    return TrainState(
        params=params,
        averaged=jax.tree.map(jnp.copy, params.policy),  # a copy: buffers are donated once
        optimiser=make_optimiser(config.ppo, PpoParams.of(config)).init(params),
        normaliser=initial_normaliser(config.network, signature),
        episode=episode,
        observation=observation,
        key=keys.rest,
        update=jnp.int32(0),
    )
