"""Whole episodes, walked with exploration: what the faithful mode asks the exact planner about."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array
from jaxtyping import Bool, Float, Int, Key

from jaxleas.distillation.collect import Walks
from jaxleas.distillation.config import SteeringRun
from jaxleas.distillation.walking import walk_from_starts
from jaxleas.envs.steering import RewardParams, SteeringEnv, World
from jaxleas.training import ActorCritic, PpoParams, TrainState, normalise

Walk = Callable[[World, TrainState, Key[Array, ""]], Any]


@dataclass(frozen=True)
class Episodes:
    """N episodes of at most T steps, on the host; steps after an episode's end mean nothing.

    Attributes:
        walks: the configurations, [N, T+1]: what a planner is asked about.
        observation: observation before each step.
        raw_action: action before the tanh.
        location: location of the normal distribution that the action was drawn from.
        deviation: standard deviation of that distribution.
        reward: reward of each step.
        terminated: whether the step met an invalid configuration (R*, C).
        reached: whether the step reached a goal.
        steps: number of steps of each episode, including its last one.
        failure_cost: additional cost of an invalid configuration over a valid one.
        update: policy updates that the walking policy had seen.
    """

    walks: Walks
    observation: Float[np.ndarray, "N T size"]
    raw_action: Float[np.ndarray, "N T 4"]
    location: Float[np.ndarray, "N T 4"]
    deviation: Float[np.ndarray, "N T 4"]
    reward: Float[np.ndarray, "N T"]
    terminated: Bool[np.ndarray, "N T"]
    reached: Bool[np.ndarray, "N T"]
    steps: Int[np.ndarray, " N"]
    failure_cost: float
    update: int

    def __len__(self) -> int:
        """Return the number of episodes."""
        return len(self.steps)


def make_walk(config: SteeringRun, env: SteeringEnv, networks: ActorCritic, robots: int) -> Walk:
    """Return the walk: fresh starts, then one whole episode each. It is pure; jit it.

    Args:
        config: configuration of the run.
        env: steering task; its condition ends an episode, and the exact planner is asked later.
        networks: actor and critic.
        robots: number of robots that walk at once.

    Returns:
        A function (world, state, key) -> arrays that `to_host` understands.
    """
    steps, numbers = config.env.episode_steps, PpoParams.of(config)

    def walk(world: World, state: TrainState, key: Key[Array, ""]) -> Any:
        *start_keys, noise_key = jax.random.split(key, 3)
        progress = state.update.astype(jnp.float32) / config.ppo.updates
        weights = RewardParams.at(numbers.task, progress)
        noise = jax.random.normal(noise_key, (steps, robots, env.action_size))

        def act(observation: Array, noise_now: Array) -> tuple[Array, Any]:
            normalised = normalise(observation, state.normaliser)
            logits = networks.answer(state.params.policy, normalised)
            (distribution,) = networks.signature.distributions(logits)
            raw_action = networks.signature.sample((distribution,), (noise_now,))
            choice = {
                "observation": observation,
                "raw_action": raw_action,
                "location": distribution.location,
                "deviation": distribution.deviation,
            }
            return jnp.tanh(raw_action), choice

        walked = walk_from_starts(env, world, (start_keys[0], start_keys[1]), weights, act, noise)
        record = walked.choice | {
            "reward": walked.reward,
            "terminated": walked.walking & walked.terminated,
            "reached": walked.walking & walked.reached,
            "walked": walked.walking,
        }
        valid = walked.walking & ~walked.terminated
        valid = jnp.pad(valid, ((0, 0), (1, 0)), constant_values=True)
        cost = weights.alive + weights.failure
        return (record, (walked.motion, valid)), walked.map_index, cost, state.update

    return walk


def to_host(walked: Any) -> Episodes:
    """Return the episodes of a walk, once the device has finished it."""
    (record, (motion, valid)), map_index, cost, update = jax.device_get(walked)
    walks = Walks(motion, valid, map_index)
    steps = record.pop("walked").sum(axis=1)
    return Episodes(walks, steps=steps, failure_cost=float(cost), update=int(update), **record)
