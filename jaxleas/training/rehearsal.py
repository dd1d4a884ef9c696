"""A rehearsal of a user's own task: each method is called once, before anything is written.

A task on the device is only traced, except for two draws of starts, whose values are looked at. A
task on the host takes one step. What a method gives is compared with the protocol, so that a
mistake is one sentence and not an error from the middle of a compiled program.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from jaxleas.configuration import is_own, own_code, value_of
from jaxleas.envs import (
    HostPool,
    Starts,
    Task,
    require_arrays,
    require_examination,
    require_observation,
    require_rows,
    require_same,
    require_starts,
    require_step,
    section_of,
)
from jaxleas.terrain import HELD_OUT_SEED
from jaxleas.training.beginning import actor_to_begin_with
from jaxleas.training.config import RunConfig
from jaxleas.training.networks import make_networks
from jaxleas.training.ppo_params import PpoParams
from jaxleas.types import InputError, OwnCodeError


def rehearse(config: RunConfig, task: Task) -> None:
    """Refuse a policy to begin with that does not suit the run, and a user's own task whose methods
    do not keep the protocol; methods of other tasks are not called.

    Args:
        config: configuration of the run.
        task: task of the run.

    Raises:
        OwnCodeError: a method raises an exception, or gives what cannot be used; one sentence says
            which, what it gave, and what would do.
        InputError: the policy to begin with does not suit the run.
    """
    if config.begin:
        actor_to_begin_with(config, make_networks(config.network, task.signature))
    if is_own(config.env.task):
        _require_numbers(task)
        _Rehearsal(config, task).run()


def _require_numbers(task: Task) -> None:
    for name in task.config.swept:
        value = value_of(task.config, name)
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise OwnCodeError(
                f"the task {task.config.task}: {section_of(type(task))}.swept names {name}, which"
                f" is {value!r}: only numbers can be swept"
            )


@dataclass
class _Rehearsal:
    """One rehearsal: a draw of starts and a step, with the run's own numbers of robots."""

    config: RunConfig
    task: Task

    def run(self) -> None:
        """Call each method in the order in which a training calls them."""
        task, ppo = self.task, self.config.ppo
        examination = self._call("examination", task.examination, self.config.held_out)
        self._check(require_examination, examination, task.groups)
        self._draw([HELD_OUT_SEED], 2 * examination.starts, examined=True)
        count = max(ppo.environments, ppo.candidates)
        world, starts = self._draw([self.config.terrain.first_seed], count, examined=False)
        state = self._some(starts, ppo.environments)
        self._look(world, state)
        staggered = self._traced("stagger", task.stagger, state, self._key())
        self._check(require_same, "stagger", staggered, state)
        self._advance(world, staggered)

    def _draw(self, seeds: list[int], count: int, examined: bool) -> tuple[Any, Starts]:
        task = self.task
        world = self._call("make_world", task.make_world, seeds, examined)
        if not task.on_host:
            self._check(require_arrays, "make_world", world)

        def draw(world: Any, key: Any) -> Any:
            return task.draw_starts(world, key, count, examined)

        starts = self._traced("draw_starts", draw, world, self._key())
        self._check(require_starts, starts, count)
        values = starts
        if not task.on_host:
            values = self._call("draw_starts", jax.jit(draw), world, self._key())
        self._check(_require_values, values, task.groups)
        return world, starts

    def _look(self, world: Any, state: Any) -> None:
        observation = self._traced("look", self.task.look, world, state)
        robots = self.config.ppo.environments
        self._check(require_observation, observation, self.task.signature, robots)

    def _advance(self, world: Any, state: Any) -> None:
        task, ppo = self.task, self.config.ppo
        shape, disturbance = (ppo.unroll, ppo.environments), ()
        if task.is_disturbed or task.on_host:

            def draw(key: Any) -> Any:
                return task.draw_disturbances(key, shape)

            drawn = self._traced("draw_disturbances", draw, self._key())
            if task.is_disturbed or jax.tree.leaves(drawn):
                self._check(require_rows, "draw_disturbances", drawn, shape, "steps, robots")
            disturbance = jax.tree.map(lambda leaf: _resized(leaf, leaf.shape[1:]), drawn)
        numbers = jax.tree.map(float, PpoParams.of(self.config).task)
        weights = self._traced("weights", task.weights, numbers, 0.0)
        raw = jnp.zeros((ppo.environments, task.signature.action_size))
        action = jax.eval_shape(task.signature.action, raw)
        if task.on_host:
            action = jax.device_get(task.signature.action(raw))
        arguments = (world, weights, state, action, disturbance)
        name, never_drawn = "advance", type(task).draw_disturbances is not Task.draw_disturbances
        if isinstance(disturbance, tuple) and not disturbance and never_drawn:
            name = "advance, without disturbances because is_disturbed is False,"
        answer = self._traced(name, task.advance, *arguments)
        self._check(require_step, answer, state, ppo.environments)
        self._look(world, answer[0])

    def _key(self) -> Any:
        return np.random.default_rng(0) if self.task.on_host else jax.random.key(0)

    def _some(self, starts: Starts, count: int) -> Any:
        """Return the state of `count` valid starts; of abstract ones, their shapes."""
        if self.task.on_host:
            pool = HostPool.of(starts)
            return pool.take(np.arange(count) % len(pool))[0]
        return jax.tree.map(lambda leaf: _resized(leaf, (count, *leaf.shape[1:])), starts.state)

    def _traced(self, name: str, method: Callable, *arguments: Any) -> Any:
        """Return a method's answer; on the device only its shapes."""
        if self.task.on_host:
            return self._call(name, method, *arguments)
        return self._call(name, jax.eval_shape, method, *arguments)

    def _call(self, name: str, function: Callable, *arguments: Any) -> Any:
        with own_code(f"the task {self.config.env.task}: {name}"):
            return function(*arguments)

    def _check(self, require: Callable, *arguments: Any) -> None:
        try:
            require(*arguments)
        except InputError as error:
            raise OwnCodeError(f"the task {self.config.env.task}: {error}") from error


def _require_values(starts: Starts, groups: tuple[str, ...]) -> None:
    """Refuse starts of which none is valid, or one is of a group that the task does not name."""
    group = np.asarray(starts.group)
    outside = group[(group < 0) | (group >= len(groups))]
    if len(outside):
        raise InputError(
            f"draw_starts gives the group {outside[0]}, but the task's groups are"
            f" {', '.join(groups)}: 0 to {len(groups) - 1}"
        )
    if not np.any(starts.valid):
        raise InputError(
            f"draw_starts gives {len(group)} starts, none of which is valid: no episode can begin"
        )


def _resized(leaf: Any, shape: tuple[int, ...]) -> Any:
    if isinstance(leaf, jax.ShapeDtypeStruct):
        return jax.ShapeDtypeStruct(shape, leaf.dtype)
    return leaf[0]
