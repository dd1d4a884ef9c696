"""The state of a run before its first update, on the device and on the host."""

from typing import Any

import jax
import jax.numpy as jnp
from flax import struct
from jax import Array
from jaxtyping import Int, Key

from jaxleas.envs import HostPool, Signature, Task, as_numpy, pool_of, take
from jaxleas.training.config import RunConfig
from jaxleas.training.failures import no_failures
from jaxleas.training.networks import ActorCritic
from jaxleas.training.normaliser import initial_normaliser
from jaxleas.training.optimiser import make_optimiser
from jaxleas.training.ppo_params import PpoParams
from jaxleas.training.train_state import TrainState


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
    episode, group = take(pool_of(starts), keys.take, count)
    observation = task.signature.pack(task.look(world, episode))
    # Episodes that began at different times end at different times: no wave of resets.
    episode = task.stagger(episode, keys.stagger)
    state = _state(config, task.signature, networks, keys, episode, observation)
    failures = no_failures(config.ppo, group, len(task.groups))
    return state.replace(failures=failures)  # type: ignore[attr-defined]


def initial_host_state(
    config: RunConfig, task: Task, world: Any, networks: ActorCritic
) -> TrainState:
    """Return the state before the first update of a task that steps on the host."""
    from jaxleas.training.walkers.host import generator_of, look

    keys = FirstKeys.of(config.seed)
    count = config.ppo.environments
    starts = task.draw_starts(world, generator_of(keys.pool), max(count, config.ppo.candidates))
    pool = HostPool.of(starts)
    episode, group = pool.take(pool.draw_picks(generator_of(keys.take), (count,)))
    episode = as_numpy(task.stagger(episode, generator_of(keys.stagger)))
    seen = look(task, world, episode)
    state = _state(config, task.signature, networks, keys, episode, seen)
    failures = no_failures(config.ppo, group, len(task.groups))
    return state.replace(failures=failures)  # type: ignore[attr-defined]


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
