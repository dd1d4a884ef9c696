"""What a policy really sees: recorded from its own walks, and edge cases after them."""

from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array
from jaxtyping import Float, Key

from jaxleas.envs.environment import Task
from jaxleas.envs.host_starts import HostPool
from jaxleas.envs.starts import pool_of, take
from jaxleas.training.policy import Policy

LEAST_OBSERVATIONS = 10_000


def record_observations(
    policy: Policy,
    task: Task,
    world: Any,
    key: Key[Array, ""],
    robots: int = 128,
    steps: int = 200,
) -> Float[np.ndarray, "count seen"]:
    """Return 10,000 or more observations of the policy's own walks, and edge cases after them.

    Robots walk from random starts, each to its end or for `steps` steps, in as many rounds as it
    takes (a policy that falls at once needs more of them).

    Args:
        policy: to be recorded.
        task: what it walks in.
        world: what the robots stand in.
        key: randomness, consumed here.
        robots: number of robots that walk at once.
        steps: most steps of each.

    Returns:
        What the actor sees, one vector each.
    """
    record = _record_on_host if task.on_host else _record_on_device
    recorded: list[np.ndarray] = []
    while sum(map(len, recorded)) < LEAST_OBSERVATIONS:
        key, round_key = jax.random.split(key)
        seen, walking = record(policy, task, world, round_key, robots, steps)
        recorded.append(np.asarray(seen)[np.asarray(walking)])
    return np.concatenate([*recorded, edge_cases(policy)])


def _record_on_device(
    policy: Policy, task: Task, world: Any, key: Array, robots: int, steps: int
) -> tuple[Array, Array]:
    """Return what every robot sees before each step, and whether it still walks then."""
    weights = task.weights(_numbers(task), 0.0)
    disturbance_key, pool_key, take_key = jax.random.split(key, 3)

    @jax.jit
    def walk(policy: Policy, world: Any) -> tuple[Array, Array]:
        starts = task.draw_starts(world, pool_key, 4 * robots, examined=True)
        episode, _ = take(pool_of(starts), take_key, robots)
        disturbances = task.draw_disturbances(disturbance_key, (steps, robots))

        def advance(carry, disturbance):
            episode, walking = carry
            seen = task.signature.for_actor(task.signature.pack(task.look(world, episode)))
            action = policy.signature.mode(policy.answer_vector(seen))
            after, result = task.advance(world, weights, episode, action, disturbance)
            over = result.terminated | result.truncated | result.reached
            return (after, walking & ~over), (seen, walking)

        carry = (episode, jnp.ones(robots, dtype=bool))
        return jax.lax.scan(advance, carry, disturbances, length=steps)[1]

    return walk(policy, world)


def _record_on_host(
    policy: Policy, task: Task, world: Any, key: Array, robots: int, steps: int
) -> tuple[np.ndarray, np.ndarray]:
    """Return the same of a task that steps on the host."""
    words = np.asarray(jax.random.key_data(key)).ravel().tolist()
    generator = np.random.default_rng(words)
    weights = task.weights(jax.tree.map(float, _numbers(task)), 0.0)
    pool = HostPool.of(task.draw_starts(world, generator, 4 * robots, examined=True))
    episode, _ = pool.take(pool.draw_picks(generator, (robots,)))
    act = jax.jit(lambda policy, seen: policy.signature.mode(policy.answer_vector(seen)))
    walking, record = np.ones(robots, dtype=bool), []
    for _ in range(steps):
        if not walking.any():
            break
        packed = np.asarray(task.signature.pack(task.look(world, episode)), np.float32)
        seen = np.asarray(task.signature.for_actor(packed))
        action = jax.device_get(act(policy, seen))
        drawn = task.draw_disturbances(generator, (1, robots))
        disturbance = jax.tree.map(lambda leaf: leaf[0], drawn)
        episode, result = task.advance(world, weights, episode, action, disturbance)
        record.append((seen, walking))
        walking = walking & ~(result.terminated | result.truncated | result.reached)
    return np.stack([seen for seen, _ in record]), np.stack([walks for _, walks in record])


def _numbers(task: Task) -> dict[str, Any]:
    from jaxleas.configuration.values import value_of

    return {name: jnp.float32(value_of(task.config, name)) for name in task.config.swept}


def edge_cases(policy: Policy) -> Float[np.ndarray, "cases seen"]:
    """Return observations at the ends of their ranges, and one value at a time far beyond."""
    mean, deviation = np.asarray(policy.mean), np.asarray(policy.deviation)
    levels = (-1.0, -1e-6, 0.0, 1e-6, 1.0)
    whole = [mean + level * deviation for level in levels]
    # The clip must catch these. Not all values at once: no terrain does that, and float32 sums of
    # a hundred large terms differ by more than the tolerance without anything being wrong.
    single = [
        mean + level * deviation * np.eye(len(mean))[index]
        for level in (-1e6, -1.0, 1.0, 1e6)
        for index in range(len(mean))
    ]
    return np.array([*whole, *single], dtype=np.float32)
