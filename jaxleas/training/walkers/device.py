"""The roll-out of a task that steps on the device: one scan inside the train step's program."""

from collections.abc import Callable

import jax
import jax.numpy as jnp
from jax import Array

from jaxleas.envs import Task, draw_picks, pool_of, restart_where
from jaxleas.training.config import RunConfig
from jaxleas.training.loss import Experience
from jaxleas.training.networks import ActorCritic
from jaxleas.training.normaliser import normalise
from jaxleas.training.ppo_params import PpoParams
from jaxleas.training.train_state import TrainState
from jaxleas.training.walkers.metrics import walk_metrics


def make_walk(config: RunConfig, task: Task, networks: ActorCritic) -> Callable:
    """Return the roll-out: (world, state, numbers, key) -> state, experience, metrics."""
    ppo, signature = config.ppo, task.signature
    shape = (ppo.unroll, ppo.environments)

    def walk(world, state: TrainState, numbers: PpoParams, key: Array):
        if task.is_disturbed:
            key, disturbance_key = jax.random.split(key)
            disturbances = task.draw_disturbances(disturbance_key, shape)
        else:
            disturbances = ()
        pool_key, noise_key, restart_key = jax.random.split(key, 3)
        progress = state.update.astype(jnp.float32) / ppo.updates
        weights = task.weights(numbers.task, progress)
        pool = pool_of(task.draw_starts(world, pool_key, ppo.candidates))
        # All random numbers are drawn in bulk: one key per batch, not one per step or robot.
        picks = draw_picks(pool, restart_key, shape)
        noise = signature.draw_noise(noise_key, shape)

        def advance(carry, inputs):
            episode, observation = carry
            noise_now, pick, disturbance = inputs
            seen = normalise(observation, state.normaliser)
            distributions = signature.distributions(networks.answer(state.params.policy, seen))
            raw_action = signature.sample(distributions, noise_now)
            action = signature.action(raw_action)
            after, result = task.advance(world, weights, episode, action, disturbance)
            episode = restart_where(result.terminated | result.truncated, after, pool, pick)
            record = Experience(
                observation=observation,
                raw_action=raw_action,
                distributions=distributions,
                reward=result.reward,
                terminated=result.terminated.astype(jnp.float32),
                truncated=result.truncated.astype(jnp.float32),
            )
            observation = signature.pack(task.look(world, episode))
            return (episode, observation), (record, result.reached, result.measures)

        (episode, observation), (batch, reached, measures) = jax.lax.scan(
            advance, (state.episode, state.observation), (noise, picks, disturbances)
        )
        valid_starts = pool.valid_count / ppo.candidates
        metrics = walk_metrics(ppo, batch, reached, measures, valid_starts)
        state = state.replace(episode=episode, observation=observation)  # type: ignore[attr-defined]
        return state, batch, metrics

    return walk
