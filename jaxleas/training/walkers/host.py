"""The roll-out of a task that steps on the host: the network is jitted, the steps are NumPy's.

There is no callback inside a program: on CPUs callbacks can hang. Network and task alternate.
"""

from typing import Any

import jax
import numpy as np
from jax import Array

from jaxleas.envs import HostPool, Task
from jaxleas.training.config import RunConfig
from jaxleas.training.loss import Experience
from jaxleas.training.networks import ActorCritic
from jaxleas.training.normaliser import normalise
from jaxleas.training.ppo_params import PpoParams
from jaxleas.training.train_state import TrainState
from jaxleas.training.walkers.metrics import Metrics, walk_metrics


def generator_of(key: Array) -> np.random.Generator:
    """Return the NumPy generator of random numbers that a JAX key seeds."""
    return np.random.default_rng(np.asarray(jax.random.key_data(key)).ravel().tolist())


class HostWalker:
    """Walks robots on the host, with the signature of `make_walk`'s function.

    Args:
        config: configuration of the run.
        task: task that steps on the host.
        networks: actor and critic.
    """

    def __init__(self, config: RunConfig, task: Task, networks: ActorCritic) -> None:
        self._ppo, self._task = config.ppo, task
        self._shape = (config.ppo.unroll, config.ppo.environments)
        signature = task.signature

        def draw(key: Array) -> tuple[Any, ...]:
            return signature.draw_noise(key, self._shape)

        def act(normaliser, policy, observation, noise):
            seen = normalise(observation, normaliser)
            distributions = signature.distributions(networks.answer(policy, seen))
            raw_action = signature.sample(distributions, noise)
            return raw_action, distributions, signature.action(raw_action)

        self._draw, self._act = jax.jit(draw), jax.jit(act)

    def __call__(
        self, world: Any, state: TrainState, numbers: PpoParams, key: Array
    ) -> tuple[TrainState, Experience, Metrics]:
        """Return the state after `ppo.unroll` steps of every robot, the experience, and metrics.

        Args:
            world: world that the robots walk in.
            state: state before the roll-out.
            numbers: hyperparameters.
            key: randomness, consumed here.
        """
        ppo, task = self._ppo, self._task
        noise_key, host_key = jax.random.split(key)
        generator = generator_of(host_key)
        noise = jax.tree.map(np.asarray, self._draw(noise_key))
        disturbances = task.draw_disturbances(generator, self._shape)
        pool = HostPool.of(task.draw_starts(world, generator, ppo.candidates))
        picks = pool.draw_picks(generator, self._shape)
        weights = task.weights(jax.tree.map(float, numbers.task), int(state.update) / ppo.updates)
        policy, normaliser = state.params.policy, state.normaliser
        episode, observation = state.episode, state.observation
        records = []
        for step in range(ppo.unroll):
            raw_action, distributions, action = jax.device_get(
                self._act(normaliser, policy, observation, _at(noise, step))
            )
            after, result = task.advance(world, weights, episode, action, _at(disturbances, step))
            terminated, truncated = np.asarray(result.terminated), np.asarray(result.truncated)
            episode = pool.restart_where(terminated | truncated, after, picks[step])
            record: Any = {
                "observation": observation,
                "raw_action": raw_action,
                "distributions": distributions,
                "reward": np.asarray(result.reward, np.float32),
                "terminated": terminated.astype(np.float32),
                "truncated": truncated.astype(np.float32),
            }
            records.append((record, result.reached, result.measures))
            observation = look(task, world, episode)
        walked, reached, measures = jax.tree.map(lambda *each: np.stack(each), *records)
        batch = Experience(**walked)
        metrics = walk_metrics(ppo, batch, reached, measures, len(pool) / pool.drawn)
        state = state.replace(episode=episode, observation=observation)  # type: ignore[attr-defined]
        return state, batch, metrics


def look(task: Task, world: Any, episode: Any) -> np.ndarray:
    """Return the observation on the host, as the one float32 vector that networks take."""
    return np.asarray(task.signature.pack(task.look(world, episode)), np.float32)


def _at(tree: Any, step: int) -> Any:
    return jax.tree.map(lambda leaf: leaf[step], tree)
