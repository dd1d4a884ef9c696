"""The steering task as a Brax `Env`, for Brax's own trainers and wrappers.

Importing this module imports Brax's environments and with them its physics; no other module of the
package does so.
"""

from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp
from brax.envs import base
from brax.envs.base import Env, Wrapper
from brax.envs.wrappers.training import VmapWrapper

from jaxleas.envs.steering.env import SteeringEnv
from jaxleas.envs.steering.reward import RewardParams
from jaxleas.envs.steering.starts import begin
from jaxleas.envs.steering.world import World

# A flax dataclass, which type checkers do not see through.
State: Any = base.State

CANDIDATES = 8  # starts drawn at a reset; the first valid one is taken


class BraxSteering(Env):
    """One robot in a world, in Brax's terms.

    `state.info` carries the random key of the next start, whether the episode was truncated, and
    the margin of the condition; `state.pipeline_state` is the steering state.
    """

    def __init__(self, env: SteeringEnv, world: World) -> None:
        self.steering = env
        self.world = world
        self._weights = RewardParams.of(env.config.reward)

    def reset(self, rng: jax.Array) -> Any:
        """Draw terrain, start, heading and goal; return the state at that start."""
        pool_key, take_key, next_key = jax.random.split(rng, 3)
        keys = (pool_key, take_key)
        state, observation = begin(self.steering, self.world, keys, 1, of=CANDIDATES)
        state, observation = jax.tree.map(lambda leaf: leaf[0], (state, observation))
        zero = jnp.float32(0.0)
        info = {"next_start": next_key, "truncation": zero, "margin": zero}
        return State(state, observation, zero, zero, {"reached": zero}, info)

    def step(self, state: Any, action: jax.Array) -> Any:
        """Advance one time step; `done` is set where the episode failed and where it is cut."""
        after, result = self.steering.step(
            self.world.atlas, self._weights, state.pipeline_state, action, self.world.seen
        )
        truncation = result.truncated.astype(jnp.float32)
        info = state.info | {"truncation": truncation, "margin": result.margin}
        return state.replace(
            pipeline_state=after,
            obs=result.observation,
            reward=result.reward,
            done=jnp.maximum(result.terminated.astype(jnp.float32), truncation),
            metrics={"reached": result.reached.astype(jnp.float32)},
            info=info,
        )

    @property
    def observation_size(self) -> int:
        """Number of values in an observation."""
        return self.steering.layout.size

    @property
    def action_size(self) -> int:
        """Number of values in an action."""
        return self.steering.action_size

    @property
    def backend(self) -> str:
        """Name of the physics backend that Brax asks for; steering has no physics."""
        return "kinematic"


class FreshStartWrapper(Wrapper):
    """Wrapper that gives every finished episode a new start.

    Brax's `AutoResetWrapper` always returns each environment to the one start that it cached.
    """

    def reset(self, rng: jax.Array) -> Any:
        """Reset a batch of environments and count their episodes' steps."""
        state: Any = self.env.reset(rng)
        return state.replace(info=state.info | {"steps": jnp.zeros(state.done.shape)})

    def step(self, state: Any, action: jax.Array) -> Any:
        """Step; where the previous episode was over, step from a fresh start instead."""
        state = self._restart(state)
        steps = state.info["steps"] + 1.0
        after: Any = self.env.step(state, action)
        return after.replace(info=after.info | {"steps": steps})

    def _restart(self, state: Any) -> Any:
        fresh: Any = self.env.reset(state.info["next_start"])
        done = state.done.astype(bool)

        def pick(new: jax.Array, old: jax.Array) -> jax.Array:
            flag = done.reshape(done.shape + (1,) * (old.ndim - done.ndim))
            return jnp.where(flag, new, old)

        info = dict(state.info)
        for name, value in fresh.info.items():
            info[name] = jax.vmap(jnp.where)(done, value, info[name])
        info["steps"] = jnp.where(done, 0.0, info["steps"])
        return state.replace(
            pipeline_state=jax.tree.map(pick, fresh.pipeline_state, state.pipeline_state),
            obs=pick(fresh.obs, state.obs),
            info=info,
        )


def wrap_for_training(
    env: BraxSteering,
    episode_length: int = 0,
    action_repeat: int = 1,
    randomization_fn: Callable[..., Any] | None = None,
) -> Wrapper:
    """Return the batched environment; give this as `wrap_env_fn` to Brax's `ppo.train`.

    Args:
        env: Brax environment of the task, whose configuration sets the episode's length.
        episode_length: length that Brax passes; it is ignored.
        action_repeat: number of repetitions of each action; it must be 1.
        randomization_fn: domain randomisation; it must be None, as every start draws its own
            terrain.

    Raises:
        ValueError: an argument asks for what the task already does itself.
    """
    del episode_length
    if action_repeat != 1 or randomization_fn is not None:
        raise ValueError("steering repeats no action and draws its own terrain at every reset")
    return FreshStartWrapper(VmapWrapper(env))
