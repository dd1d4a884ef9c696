"""A population: trainings that differ in seeds and numbers only, in one compiled program.

The members are divided among the devices, and the terrain exists once. On a processor the members
of a device run one after another inside the program (`lax.map`): vectorised they took twice as
long, because batches of small matrix products run on one thread. Other devices run them all at once
(`vmap`).
"""

from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass, field
from typing import Any

import jax
import numpy as np
from jax import Array
from jax.sharding import Mesh, NamedSharding, PartitionSpec

from jaxleas.configuration import fields_of, value_of
from jaxleas.envs import Task
from jaxleas.training import (
    Policy,
    PpoParams,
    RunConfig,
    TrainState,
    held_out_world,
    initial_state,
    make_examination,
    make_networks,
    make_task,
    make_train_step,
    policy_of,
    swept_fields,
    training_world,
)
from jaxleas.types import InputError

AXIS = "members"
Metrics = dict[str, Array]


@dataclass
class Population:
    """The compiled pieces of a population.

    Attributes:
        configs: configurations of the members; they differ in the seed and in `swept_fields` alone.
        allow: user's own code that may be run, as MODULE:CLASS.
        task: task that the members learn.
        world: world that they train in, shared by all.
        held_out: world that they are examined in, likewise.
        train_step: function (world, states, params) -> (states, metrics [members]); it donates the
            states.
        examine: function (held-out world, normaliser, policy) -> fractions [members].
        fresh_states: function that makes the states before the first update; every array is
            [members, ...].
    """

    configs: Sequence[RunConfig]
    allow: Collection[str] = ()
    task: Task = field(init=False)
    world: Any = field(init=False)
    held_out: Any = field(init=False)
    train_step: Callable[[Any, TrainState, PpoParams], tuple[TrainState, Metrics]] = field(
        init=False
    )
    examine: Callable[[Any, Any, Any], Metrics] = field(init=False)
    fresh_states: Callable[[], TrainState] = field(init=False)

    def __post_init__(self) -> None:
        config = require_one_program(self.configs)
        mesh = _mesh(len(self.configs))
        whole = NamedSharding(mesh, PartitionSpec())
        self._divided = NamedSharding(mesh, PartitionSpec(AXIS))
        self.task = make_task(config, self.allow)
        self.world = jax.device_put(training_world(config, self.task), whole)
        self.held_out = jax.device_put(held_out_world(config, self.task), whole)
        self.networks = networks = make_networks(config.network, self.task.signature)
        step = make_train_step(config, self.task, networks)
        examine = make_examination(config, self.task, networks)

        def advance(world: Any, states: TrainState, params: PpoParams):
            return each_member(lambda member: step(world, *member), (states, params))

        def examine_all(world: Any, normaliser: Any, policy: Any) -> Metrics:
            return each_member(lambda member: examine(world, *member), (normaliser, policy))

        def begin(world: Any, seeds: Array) -> TrainState:
            return each_member(
                lambda seed: initial_state(config, self.task, world, networks, seed), seeds
            )

        options = _compiler_options(mesh)
        self.train_step = jax.jit(
            _each_device(advance, mesh, 2), donate_argnums=1, compiler_options=options
        )
        self.examine = jax.jit(_each_device(examine_all, mesh, 2), compiler_options=options)
        compiled = jax.jit(_each_device(begin, mesh, 1))
        seeds = np.array([each.seed for each in self.configs], np.int32)
        self.fresh_states = lambda: compiled(self.world, self.place(seeds))

    def place(self, tree: Any) -> Any:
        """Divide arrays [members, ...] among the devices."""
        return jax.tree.map(lambda leaf: jax.device_put(leaf, self._divided), tree)

    def policy(self, states: TrainState, member: int) -> Policy:
        """Return a member's policy: the averaged actor, with the member's own configuration."""
        one = member_of((states.normaliser, states.averaged), member)
        return policy_of(self.networks, self.configs[member].env, *one)


def member_of(tree: Any, member: int) -> Any:
    """Return one member's part of arrays [members, ...]."""
    return jax.tree.map(lambda leaf: leaf[member], tree)


def require_one_program(configs: Sequence[RunConfig]) -> RunConfig:
    """Return the configuration that stands for all members: that of the first.

    Raises:
        InputError: members differ in a field that changes the program, or there are no members.
    """
    if not configs:
        raise InputError("a population needs at least one member")
    first = configs[0]
    swept = swept_fields(first.env)
    same = {"seed", *swept}
    for index, other in enumerate(configs[1:], start=1):
        if type(other) is not type(first):
            raise InputError(
                f"members 0 and {index} are of different tasks: {first.env.task} and"
                f" {other.env.task}"
            )
        for each in fields_of(type(first)):
            if each.section is not None or each.name in same:
                continue
            left, right = value_of(first, each.name), value_of(other, each.name)
            if left != right:
                raise InputError(
                    f"members 0 and {index} differ in {each.name} ({left!r} and {right!r}), which"
                    f" is another program; they may differ in seed, {', '.join(swept)}"
                )
    return first


def each_member(function: Callable[[Any], Any], members: Any) -> Any:
    """Return the results of `function` for every member of arrays [members, ...]."""
    if jax.default_backend() == "cpu":
        return jax.lax.map(function, members)
    return jax.vmap(function)(members)


def _mesh(members: int) -> Mesh:
    """Return a mesh of the most devices of this process that divide the members evenly."""
    devices = jax.local_devices()
    count = next(n for n in range(min(members, len(devices)), 0, -1) if members % n == 0)
    return Mesh(np.array(devices[:count]), (AXIS,))


def _compiler_options(mesh: Mesh) -> dict[str, Any] | None:
    """Give each core its own members, rather than all cores a part of every matrix product."""
    several_cores = jax.default_backend() == "cpu" and mesh.size > 1
    return {"xla_cpu_multi_thread_eigen": False} if several_cores else None


def _each_device(function: Callable, mesh: Mesh, arguments: int) -> Callable:
    """Return `function`(world, ...) run by each device on its own members."""
    divided = PartitionSpec(AXIS)
    return jax.shard_map(
        function,
        mesh=mesh,
        in_specs=(PartitionSpec(), *[divided] * arguments),
        out_specs=divided,
        check_vma=False,
    )
