"""The small examination during training: how many held-out links does the policy cross?"""

from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp
from jax import Array

from jaxleas.envs.steering.env import SteeringEnv
from jaxleas.envs.steering.reward import RewardParams
from jaxleas.envs.steering.starts import draw_starts, take
from jaxleas.envs.steering.world import World
from jaxleas.training.brax_blocks import PPONetworks
from jaxleas.training.config import RunConfig

# Of the examination's own draws: the same starts whenever and by whomever it is held.
EXAMINATION_KEY = 20_210_530


def make_examination(
    config: RunConfig,
    env: SteeringEnv,
    networks: PPONetworks,
    divide: Callable[[Any], Any] = lambda robots: robots,
) -> Callable[[World, Any, Any], dict[str, Array]]:
    """Return the examination: (held-out world, normaliser, policy) -> fractions of starts.

    Every robot walks, by the policy's mean, until its first goal is reached, its configuration is
    invalid, or the time is up; all stop early when none walks any more.

    Args:
        config: of the run.
        env: the task.
        networks: actor and critic.
        divide: lays arrays with one entry a robot out over several devices.
    """
    held_out = config.held_out
    # Everybody has a link to cross here; in training some begin with a random goal.
    always_a_link = config.env.model_copy(update={"wander_share": 0.0})
    env = SteeringEnv(always_a_link, env.condition, env.foresight)
    weights = RewardParams.of(config.env.reward)
    distribution = networks.parametric_action_distribution

    def examine(world: World, normaliser: Any, policy: Any) -> dict[str, Array]:
        pool_key, take_key = jax.random.split(jax.random.key(EXAMINATION_KEY))
        pool = draw_starts(env, world, pool_key, 2 * held_out.starts)
        episode, observation = divide(take(pool, take_key, held_out.starts))
        nobody = jnp.zeros(held_out.starts, dtype=bool)

        def someone_walks(carry):
            step, _, _, reached, invalid = carry
            return (step < held_out.steps) & ~jnp.all(reached | invalid)

        def advance(carry):
            step, episode, observation, reached, invalid = carry
            logits = networks.policy_network.apply(normaliser, policy, observation)
            episode, outcome = env.step(world.atlas, weights, episode, distribution.mode(logits))
            walking = ~(reached | invalid)
            reached = reached | (walking & outcome.reached)
            invalid = invalid | (walking & outcome.terminated)
            return step + 1, episode, outcome.observation, reached, invalid

        carry = (jnp.int32(0), episode, observation, nobody, nobody)
        _, _, _, reached, invalid = jax.lax.while_loop(someone_walks, advance, carry)
        return {
            "held_out/reached": jnp.mean(reached),
            "held_out/invalid": jnp.mean(invalid),
            "held_out/stopped": jnp.mean(~reached & ~invalid),
        }

    return examine
