"""The roll-out: every robot takes some steps with the present policy."""

from collections.abc import Callable

import jax
import jax.numpy as jnp
from jax import Array

from jaxleas.envs.steering.env import SteeringEnv
from jaxleas.envs.steering.starts import draw_picks, draw_starts, restart_where
from jaxleas.envs.steering.world import World
from jaxleas.training.config import RunConfig
from jaxleas.training.loss import Experience, action_distribution
from jaxleas.training.networks import dense, normalise
from jaxleas.training.ppo_params import PpoParams
from jaxleas.training.train_state import TrainState


def make_walk(config: RunConfig, env: SteeringEnv) -> Callable:
    """Return the roll-out: (world, state, numbers, key) -> state, experience, metrics."""
    ppo = config.ppo

    def walk(world: World, state: TrainState, numbers: PpoParams, key: Array):
        pool_key, noise_key, restart_key = jax.random.split(key, 3)
        progress = state.update.astype(jnp.float32) / ppo.updates
        weights = numbers.reward_weights(progress)
        pool = draw_starts(env, world, pool_key, ppo.candidates)
        # All that is random in one draw each: one key a batch, not one a step or a robot.
        picks = draw_picks(pool, restart_key, (ppo.unroll, ppo.environments))
        noise = jax.random.normal(noise_key, (ppo.unroll, ppo.environments, env.action_size))

        def advance(carry, inputs):
            episode, observation = carry
            noise_now, pick = inputs
            normalised = normalise(observation, state.normaliser)
            location, deviation = action_distribution(
                dense(state.params.policy, normalised, config.network)
            )
            raw_action = location + deviation * noise_now
            after, verdict = env.advance(world.atlas, weights, episode, jnp.tanh(raw_action))
            episode = restart_where(verdict.terminated | verdict.truncated, after, pool, pick)
            record = Experience(
                observation=observation,
                raw_action=raw_action,
                location=location,
                deviation=deviation,
                reward=verdict.reward,
                terminated=verdict.terminated.astype(jnp.float32),
                truncated=verdict.truncated.astype(jnp.float32),
            )
            return (episode, env.look(world.atlas, episode)), (record, verdict.reached)

        (episode, observation), (batch, reached) = jax.lax.scan(
            advance, (state.episode, state.observation), (noise, picks)
        )
        failed, cut = jnp.sum(batch.terminated), jnp.sum(batch.truncated)
        metrics = {
            "walk/reward": jnp.mean(batch.reward),
            "walk/failures_per_1000_steps": 1000.0 * failed / ppo.batch,
            "walk/goals_per_1000_steps": 1000.0 * jnp.sum(reached) / ppo.batch,
            "walk/valid_starts": pool.valid_count / ppo.candidates,
            "walk/episodes": failed + cut,
        }
        state = state.replace(episode=episode, observation=observation)  # type: ignore[attr-defined]
        return state, batch, metrics

    return walk
