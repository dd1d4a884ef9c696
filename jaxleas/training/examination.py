"""The small examination during training: how many held-out starts reach their goal?"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import reduce
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array

from jaxleas.envs import Examination, HostPool, Task, pool_of, take
from jaxleas.training.config import RunConfig
from jaxleas.training.networks import ActorCritic
from jaxleas.training.normaliser import normalise
from jaxleas.training.ppo_params import PpoParams
from jaxleas.training.walkers.host import look

# Seed of the examination's own draws: the same starts at every examination of every run.
EXAMINATION_KEY = 20_210_530
REACHED = "held_out/reached"
VALID = "held_out/valid"
WORST = "held_out/worst"
Examine = Callable[[Any, Any, Any], dict[str, Any]]


def make_examination(
    config: RunConfig,
    task: Task,
    networks: ActorCritic,
    divide: Callable[[Any], Any] = lambda robots: robots,
) -> Examine:
    """Return the examination: (held-out world, normaliser, policy) -> fractions of starts.

    Every robot walks, by the policy's mode, until it reaches its goal, fails, or runs out of time;
    the loop ends early when no robot walks any more. It is pure; jit it. `HostExaminer` is its
    twin.

    Args:
        config: configuration of the run.
        task: task that steps on the device.
        networks: actor and critic.
        divide: function that lays arrays with one entry per robot out over several devices.
    """
    examination = task.examination(config.held_out)
    weights = task.weights(PpoParams.of(config).task, 0.0)
    signature = task.signature

    def examine(world: Any, normaliser: Any, policy: Any) -> dict[str, Array]:
        pool_key, take_key = jax.random.split(jax.random.key(EXAMINATION_KEY))
        disturbance_key = jax.random.key(EXAMINATION_KEY + 1)
        pool = pool_of(task.draw_starts(world, pool_key, 2 * examination.starts, examined=True))
        episode, group = divide(take(pool, take_key, examination.starts))
        none = jnp.zeros(examination.starts, dtype=bool)

        def some_walk(carry):
            step, _, reached, failed = carry
            return (step < examination.steps) & ~jnp.all(reached | failed)

        def advance(carry):
            step, episode, reached, failed = carry
            seen = normalise(signature.pack(task.look(world, episode)), normaliser)
            action = signature.mode(networks.plain(policy, seen))
            disturbance = ()
            if task.is_disturbed:
                now = jax.random.fold_in(disturbance_key, step)
                drawn = task.draw_disturbances(now, (1, examination.starts))
                disturbance = jax.tree.map(lambda leaf: leaf[0], drawn)
            episode, result = task.advance(world, weights, episode, action, disturbance)
            walking = ~(reached | failed)
            reached = reached | (walking & result.reached)
            failed = failed | (walking & result.terminated)
            return step + 1, episode, reached, failed

        carry = (jnp.int32(0), episode, none, none)
        _, _, reached, failed = jax.lax.while_loop(some_walk, advance, carry)
        return _fractions(examination, task.groups, reached, failed, group)

    return examine


@dataclass
class HostExaminer:
    """The examination of a task that steps on the host; called as `make_examination`'s function.

    Attributes:
        config: configuration of the run.
        task: task that steps on the host.
        networks: actor and critic.
    """

    config: RunConfig
    task: Task
    networks: ActorCritic

    def __post_init__(self) -> None:
        signature, networks = self.task.signature, self.networks

        def act(normaliser: Any, policy: Any, observation: Array) -> Any:
            return signature.mode(networks.plain(policy, normalise(observation, normaliser)))

        self._act = jax.jit(act)

    def __call__(self, world: Any, normaliser: Any, policy: Any) -> dict[str, Any]:
        """Return the fractions of starts that reached, failed and stopped."""
        task, examination = self.task, self.task.examination(self.config.held_out)
        generator = np.random.default_rng(EXAMINATION_KEY)
        numbers: Mapping[str, Any] = PpoParams.of(self.config).task
        weights = task.weights(jax.tree.map(float, numbers), 0.0)
        starts = task.draw_starts(world, generator, 2 * examination.starts, examined=True)
        pool = HostPool.of(starts)
        episode, group = pool.take(pool.draw_picks(generator, (examination.starts,)))
        reached = failed = np.zeros(examination.starts, dtype=bool)
        for _ in range(examination.steps):
            if np.all(reached | failed):
                break
            action = jax.device_get(self._act(normaliser, policy, look(task, world, episode)))
            drawn = task.draw_disturbances(generator, (1, examination.starts))
            disturbance = jax.tree.map(lambda leaf: leaf[0], drawn)
            episode, result = task.advance(world, weights, episode, action, disturbance)
            walking = ~(reached | failed)
            reached = reached | (walking & result.reached)
            failed = failed | (walking & result.terminated)
        return _fractions(examination, task.groups, reached, failed, group)


def _fractions(
    examination: Examination, groups: tuple[str, ...], reached: Any, failed: Any, group: Any
) -> dict[str, Any]:
    """Return the fractions of all starts, and those of each cell that is reported separately."""
    crossing = group >= 0
    for stop in examination.stops:
        crossing = crossing & (group != groups.index(stop))
    # A cell without starts has no success: NaN is logged as null.
    with np.errstate(invalid="ignore"):
        found = {
            REACHED: _share(reached, crossing) if examination.stops else reached.mean(),
            "held_out/invalid": failed.mean(),
            "held_out/stopped": (~reached & ~failed).mean(),
        }
        cells = {
            f"{REACHED}/{cell}": _share(reached, group == groups.index(cell))
            for cell in examination.cells
        } | {
            f"{VALID}/{cell}": _share(~failed, group == groups.index(cell))
            for cell in examination.stops
        }
    if examination.by_worst:
        found[WORST] = reduce(jnp.fmin, cells.values())  # of the cells that have starts
    return found | cells


def _share(good: Any, inside: Any) -> Any:
    return (good & inside).sum() / inside.sum()
