"""Walk a policy over training terrain: guide paths to ask a planner about."""

from dataclasses import dataclass
from functools import partial

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array
from jaxtyping import Bool, Float, Int, Key

from jaxleas.distillation.walking import before_first, walk_from_starts
from jaxleas.envs.steering import RewardParams, SteeringEnv, World
from jaxleas.training import Policy
from jaxleas.types import GuidePath, RootMotion, cut_walks

HOLD = 10  # steps for which a disturbance lasts: one of a step's length would average out


@dataclass(frozen=True)
class Walks:
    """N recorded walks of T steps.

    Attributes:
        motion: motions of the roots, [N, T+1].
        valid: whether every configuration up to this one satisfies R* and C.
        map_index: terrain of each walk.
    """

    motion: RootMotion
    valid: Bool[np.ndarray, "N T+1"]
    map_index: Int[np.ndarray, " N"]

    def __len__(self) -> int:
        """Return the number of walks."""
        return len(self.map_index)

    def __getitem__(self, rows: Int[np.ndarray, " M"]) -> "Walks":
        """Return some of the walks."""
        motion = jax.tree.map(lambda leaf: leaf[rows], self.motion)
        return Walks(motion, self.valid[rows], self.map_index[rows])

    def paths(self, time_step: float) -> list[GuidePath]:
        """Return each walk as a guide path, cut before its first invalid configuration."""
        return cut_walks(self.motion, self.valid, self.valid.sum(axis=1), time_step)


@dataclass(frozen=True)
class WalksWanted:
    """Which walks to collect.

    Attributes:
        count: number of walks.
        steps: steps of each walk.
        disturbances: standard deviations of the disturbances, one per walk in turn, in units of
            the action's range; 0 leaves a walk undisturbed.
    """

    count: int
    steps: int
    disturbances: Float[np.ndarray, " kinds"]


def collect(
    env: SteeringEnv,
    world: World,
    policy: Policy,
    key: Key[Array, ""],
    wanted: WalksWanted,
) -> Walks:
    """Walk robots with a policy, some of them disturbed.

    A planner's limits show where the policy does not go by itself, so disturbances of several
    strengths are added to its actions, each held for a while: one kind per robot, in turn.

    Args:
        env: steering task; its condition ends a walk.
        world: terrains and links.
        policy: policy that walks.
        key: random key, consumed here.
        wanted: number, length and disturbances of the walks.
    """
    kinds = jnp.asarray(wanted.disturbances, jnp.float32)
    scale = kinds[jnp.arange(wanted.count) % len(kinds)]
    motion, valid, map_index = _walk(env, wanted.steps, world, policy, key, scale)
    host = jax.tree.map(np.asarray, motion)
    return Walks(host, np.asarray(valid), np.asarray(map_index))


@partial(jax.jit, static_argnums=(0, 1))
def _walk(
    env: SteeringEnv,
    steps: int,
    world: World,
    policy: Policy,
    key: Array,
    scale: Float[Array, " N"],
) -> tuple[RootMotion, Array, Array]:
    *start_keys, noise_key = jax.random.split(key, 3)
    shape = (-(-steps // HOLD), len(scale), env.action_size)
    noise = jnp.repeat(jax.random.normal(noise_key, shape), HOLD, axis=0)[:steps]

    def act(observation: Array, push: Array) -> tuple[Array, None]:
        action = policy.action(observation) + scale[:, None] * push
        return jnp.clip(action, -1.0, 1.0), None

    weights = RewardParams.of(env.config.reward)
    walked = walk_from_starts(env, world, (start_keys[0], start_keys[1]), weights, act, noise)
    valid = before_first(walked.terminated) & ~walked.terminated
    valid = jnp.pad(valid, ((0, 0), (1, 0)), constant_values=True)
    return walked.motion, valid, walked.map_index
