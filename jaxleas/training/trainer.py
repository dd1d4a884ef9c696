"""The pieces of one training: task, worlds, networks, and the functions compiled from them."""

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import jax
from jax import Array

from jaxleas.envs import Task
from jaxleas.training.config import RunConfig
from jaxleas.training.devices import Devices, one_device
from jaxleas.training.examination import HostExaminer, make_examination
from jaxleas.training.first_states import initial_host_state, initial_state
from jaxleas.training.networks import ActorCritic, make_networks
from jaxleas.training.policy import Policy, policy_of
from jaxleas.training.ppo import HostTrainStep, make_train_step
from jaxleas.training.train_state import TrainState
from jaxleas.training.worlds import held_out_world, training_world
from jaxleas.types import InputError


@dataclass
class Trainer:
    """The pieces that one training needs, made once.

    Attributes:
        config: configuration of the run.
        task: task that is learned.
        devices: devices that share the training; by default the first.
        world: world that the robots train in.
        held_out: world that the robots are examined in.
        networks: actor and critic.
        train_step: function that returns the next state and metrics; it consumes the given state.
        examine: function that returns the fractions of held-out starts that reached the goal,
            failed and stopped.
        fresh_state: function that makes the state before the first update.
    """

    config: RunConfig
    task: Task
    devices: Devices = field(default_factory=one_device)
    world: Any = field(init=False)
    held_out: Any = field(init=False)
    networks: ActorCritic = field(init=False)
    train_step: Callable[[Any, TrainState], tuple[TrainState, dict[str, Array]]] = field(init=False)
    examine: Callable[[Any, Any, Any], dict[str, Any]] = field(init=False)
    fresh_state: Callable[[], TrainState] = field(init=False)

    def __post_init__(self) -> None:
        self.networks = make_networks(self.config.network, self.task.signature)
        self.world = training_world(self.config, self.task)
        self.held_out = held_out_world(self.config, self.task)
        if self.task.on_host:
            self._prepare_host()
        else:
            self._prepare_devices()

    def _prepare_devices(self) -> None:
        config, task, networks, devices = self.config, self.task, self.networks, self.devices
        self.world = jax.device_put(self.world, devices.whole)
        self.held_out = jax.device_put(self.held_out, devices.whole)
        self.train_step = jax.jit(
            make_train_step(config, task, networks, devices),
            donate_argnums=1,
            in_shardings=(devices.whole, devices.state),
            out_shardings=(devices.state, devices.whole),
        )
        self.examine = jax.jit(
            make_examination(config, task, networks, devices.divide), out_shardings=devices.whole
        )
        begin = jax.jit(
            lambda world: initial_state(config, task, world, networks),
            out_shardings=devices.state,
        )
        self.fresh_state = lambda: begin(self.world)

    def _prepare_host(self) -> None:
        config, task, networks = self.config, self.task, self.networks
        if jax.process_count() > 1:
            raise InputError(
                f"the task {config.env.task} steps on the host, which one process does alone: leave"
                " --coordinator and --process out"
            )
        self.train_step = HostTrainStep(config, task, networks, self.devices)
        self.examine = HostExaminer(config, task, networks)
        self.fresh_state = lambda: initial_host_state(config, task, self.world, networks)

    @cached_property
    def shapes(self) -> TrainState:
        """A state of the shapes and types that this training has."""
        return self.fresh_state() if self.task.on_host else jax.eval_shape(self.fresh_state)

    def place(self, state: TrainState) -> TrainState:
        """Return a state laid out for this training; all processes must call it."""
        return state if self.task.on_host else self.devices.place(state)

    def gather(self, state: TrainState) -> TrainState:
        """Return a state whose arrays this process can read whole; all processes must call it."""
        return state if self.task.on_host else self.devices.gather(state)

    def policy(self, state: TrainState) -> Policy:
        """Return the policy that is judged and exported: the averaged actor."""
        return policy_of(self.networks, self.config.env, state.normaliser, state.averaged)
