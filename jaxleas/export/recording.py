"""Observations that a policy really makes, recorded from its own walks, and edge cases."""

from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array
from jaxtyping import Float, Key

from jaxleas.envs import HostPool, Task, pool_of, take
from jaxleas.training import Policy, generator_of, task_numbers

LEAST_OBSERVATIONS = 10_000
Record = Callable[[Policy, Any, Array], tuple[Any, Any]]
"""Returns the observation of every robot before each step, and whether it still walks then."""


def record_observations(
    policy: Policy,
    task: Task,
    world: Any,
    key: Key[Array, ""],
    robots: int = 128,
    steps: int = 200,
) -> Float[np.ndarray, "count seen"]:
    """Return 10,000 or more observations of the policy's own walks, and edge cases after them.

    Robots walk from random starts, each until its episode ends or for `steps` steps, in as many
    rounds as are needed (more of them for a policy that falls at once).

    Args:
        policy: policy to record.
        task: task of the policy.
        world: world that the robots walk in.
        key: random key, consumed here.
        robots: number of robots that walk at the same time.
        steps: largest number of steps of each robot.

    Returns:
        Observations as the actor sees them, one vector each.
    """
    record = _on_host(task, robots, steps) if task.on_host else _on_device(task, robots, steps)
    recorded: list[np.ndarray] = []
    while sum(map(len, recorded)) < LEAST_OBSERVATIONS:
        key, round_key = jax.random.split(key)
        seen, walking = record(policy, world, round_key)
        recorded.append(np.asarray(seen)[np.asarray(walking)])
    return np.concatenate([*recorded, edge_cases(policy)])


def _on_device(task: Task, robots: int, steps: int) -> Record:
    """Return a function that records a round of a task that steps on the device, compiled once."""
    weights = task.weights(task_numbers(task.config), 0.0)

    def record(policy: Policy, world: Any, key: Array) -> tuple[Array, Array]:
        disturbance_key, pool_key, take_key = jax.random.split(key, 3)
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

    return jax.jit(record)


def _on_host(task: Task, robots: int, steps: int) -> Record:
    """Return a function that records a round of a task that steps on the host."""
    weights = task.weights(jax.tree.map(float, task_numbers(task.config)), 0.0)
    act = jax.jit(lambda policy, seen: policy.signature.mode(policy.answer_vector(seen)))

    def record(policy: Policy, world: Any, key: Array) -> tuple[np.ndarray, np.ndarray]:
        generator = generator_of(key)
        pool = HostPool.of(task.draw_starts(world, generator, 4 * robots, examined=True))
        episode, _ = pool.take(pool.draw_picks(generator, (robots,)))
        walking, rows = np.ones(robots, dtype=bool), []
        for _ in range(steps):
            if not walking.any():
                break
            packed = np.asarray(task.signature.pack(task.look(world, episode)), np.float32)
            seen = np.asarray(task.signature.for_actor(packed))
            action = jax.device_get(act(policy, seen))
            drawn = task.draw_disturbances(generator, (1, robots))
            disturbance = jax.tree.map(lambda leaf: leaf[0], drawn)
            episode, result = task.advance(world, weights, episode, action, disturbance)
            rows.append((seen, walking))
            walking = walking & ~(result.terminated | result.truncated | result.reached)
        return np.stack([seen for seen, _ in rows]), np.stack([walks for _, walks in rows])

    return record


def edge_cases(policy: Policy) -> Float[np.ndarray, "cases seen"]:
    """Return observations at the ends of their ranges, and with one value at a time far beyond."""
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
