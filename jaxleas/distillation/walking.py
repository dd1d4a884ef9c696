"""Walks over training terrain from fresh starts: what the labels and the faithful mode share."""

from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp
from flax import struct
from jax import Array
from jaxtyping import Bool, Float, Int, Key

from jaxleas.envs.steering import RewardParams, SteeringEnv, World, begin
from jaxleas.types import RootMotion

Act = Callable[[Array, Array], tuple[Array, Any]]
"""Returns the action for an observation with noise, and the details of the choice to keep."""


@struct.dataclass
class Walked:
    """N walks of T steps, which continue after an episode has ended: `walking` gives until when.

    Attributes:
        motion: root motions, [N, T+1].
        choice: kept details of the choice of each action, [N, T].
        reward: reward of each step.
        terminated: whether each step met an invalid configuration.
        truncated: whether each step used up the time of its episode.
        reached: whether each step reached a goal.
        map_index: terrain of each walk.
    """

    motion: RootMotion
    choice: Any
    reward: Float[Array, "N T"]
    terminated: Bool[Array, "N T"]
    truncated: Bool[Array, "N T"]
    reached: Bool[Array, "N T"]
    map_index: Int[Array, " N"]

    @property
    def walking(self) -> Bool[Array, "N T"]:
        """Return whether the episode is still running before each step."""
        return before_first(self.terminated | self.truncated)


def walk_from_starts(
    env: SteeringEnv,
    world: World,
    keys: tuple[Key[Array, ""], Key[Array, ""]],
    weights: RewardParams,
    act: Act,
    noise: Float[Array, "T N 4"],
) -> Walked:
    """Walk N robots from fresh starts for T steps; pure, to be called inside jit.

    Args:
        env: steering task.
        world: terrains and links.
        keys: random keys to draw twice as many starts, and to take valid ones; consumed here.
        weights: weights of the reward.
        act: function that chooses the actions.
        noise: noise that `act` receives step by step.
    """
    count = noise.shape[1]
    start, first_seen = begin(env, world, keys, count, of=2 * count)

    def advance(carry, noise_now):
        episode, observation = carry
        action, choice = act(observation, noise_now)
        after, step = env.step(world.atlas, weights, episode, action, world.seen)
        flags = step.terminated, step.truncated, step.reached
        return (after, step.observation), (after.motion, choice, step.reward, flags)

    _, record = jax.lax.scan(advance, (start, first_seen), noise)
    later, choice, reward, flags = jax.tree.map(lambda leaf: jnp.swapaxes(leaf, 0, 1), record)
    motion = jax.tree.map(
        lambda first, rest: jnp.concatenate([first[:, None], rest], axis=1), start.motion, later
    )
    return Walked(motion, choice, reward, *flags, map_index=start.plan.map_index)


def before_first(flag: Bool[Array, "N T"]) -> Bool[Array, "N T"]:
    """Return which steps have no flagged one before them; the first flagged step is included."""
    return jnp.cumsum(flag, axis=1) - flag == 0
