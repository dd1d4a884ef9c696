"""The protocol of a task, the only one on which learning, sweeps and export depend.

A task is a class derived from `Task`, and a section of the configuration derived from `TaskConfig`.
Its methods are pure and work on many robots at once: every array is [robots, ...]. Functions over
this protocol restart episodes, mirror experience, write policies and export them.
"""

from abc import ABC, abstractmethod
from collections.abc import Collection, Mapping, Sequence
from typing import Any, ClassVar, Self

import jax

from jaxleas.envs.signature import Signature
from jaxleas.envs.task_config import TaskConfig, WorldsConfig
from jaxleas.envs.task_values import Examination, Starts, StepResult


class Task(ABC):
    """One task for one configuration; it holds constants only.

    Arrays are JAX arrays and methods are traced, unless `on_host`: then arrays are NumPy arrays,
    methods are called directly (they may use a simulator in C), and each `key` is a
    `numpy.random.Generator`.

    Attributes:
        Config: type of the configuration section `env`.
        Worlds: type of the configuration section `terrain`.
        on_host: whether the methods work in NumPy.
        is_disturbed: whether `draw_disturbances` draws anything.
        groups: names of the groups of starts.
        config: configuration of the task.
        worlds: configuration of the worlds that its robots train in.
        signature: signature of observation and action.
    """

    Config: ClassVar[type[TaskConfig]]
    Worlds: ClassVar[type[WorldsConfig]] = WorldsConfig
    on_host: ClassVar[bool] = False
    is_disturbed: ClassVar[bool] = False
    groups: tuple[str, ...] = ("all",)

    def __init__(self, config: Any, worlds: Any) -> None:
        """Prepare the task.

        Args:
            config: configuration of the task, of type `Config`.
            worlds: configuration of the worlds that its robots train in, of type `Worlds`.
        """
        self.config = config
        self.worlds = worlds
        self.signature: Signature = config.signature()

    @classmethod
    def make(cls, config: Any, worlds: Any, allow: Collection[str] = ()) -> Self:
        """Return the task that a configuration asks for.

        Args:
            config: configuration of the task.
            worlds: configuration of the worlds that its robots train in.
            allow: user's own code that may be run, as MODULE:CLASS.
        """
        del allow
        return cls(config, worlds)

    def require_worlds(self) -> None:  # noqa: B027 (most tasks have nothing to refuse)
        """Refuse worlds that cannot be made, as far as that can be seen quickly.

        This is called before a run folder is made.

        Raises:
            InputError: the worlds cannot be made; one sentence names file and key.
        """

    @abstractmethod
    def make_world(self, seeds: Sequence[int], examined: bool) -> Any:
        """Return the world that the robots walk in, a pytree of arrays (of NumPy or JAX).

        Args:
            seeds: seeds of its arenas; training and examination never share one.
            examined: whether the world is for the examination: then every start should have a goal
                that can be reached.
        """

    @abstractmethod
    def draw_starts(self, world: Any, key: Any, count: int, examined: bool = False) -> Starts:
        """Draw candidates for the first states of episodes, anew at every call.

        Args:
            world: world returned by `make_world`.
            key: random key, consumed here.
            count: number of candidates.
            examined: whether the starts are for the examination.
        """

    def stagger(self, state: Any, key: Any) -> Any:
        """Return first states as if their episodes had begun at different times.

        Episodes that end at different times avoid a wave of restarts.

        Args:
            state: state of all robots at the beginning of their episodes.
            key: random key, consumed here.
        """
        del key
        return state

    def draw_disturbances(self, key: Any, shape: tuple[int, ...]) -> Any:
        """Draw the disturbances of a whole roll-out in bulk: a pytree of arrays [*shape, ...].

        Args:
            key: random key, consumed here.
            shape: numbers of steps and robots.
        """
        del key, shape
        return ()

    def weights(self, numbers: Mapping[str, Any], progress: Any) -> Any:
        """Return the weights of the reward, a pytree of scalars.

        Args:
            numbers: value of each field that `Config.swept` names.
            progress: completed share of the training, 0 to 1.
        """
        del progress
        return dict(numbers)

    @abstractmethod
    def advance(
        self, world: Any, weights: Any, state: Any, action: Any, disturbance: Any
    ) -> tuple[Any, StepResult]:
        """Advance one time step; return the next state and the step result.

        Args:
            world: world returned by `make_world`.
            weights: weights returned by `weights`.
            state: state of the episodes.
            action: action of each head by name, or of the only head alone; real numbers in
                [-1, 1] (`command` gives physical units), choices as indices.
            disturbance: disturbances of this step, from `draw_disturbances`.
        """

    @abstractmethod
    def look(self, world: Any, state: Any) -> Any:
        """Return the observation of a state, in physical units: by part, or the only part alone.

        Args:
            world: world returned by `make_world`.
            state: state of the episodes.
        """

    def command(self, action: Any) -> Any:
        """Return an action in physical units."""
        command = self.signature.command(action)
        return jax.device_get(command) if self.on_host else command

    def examination(self, held_out: Any) -> Examination:
        """Return how success is measured during training.

        Args:
            held_out: section `held_out` of the run's configuration, with `starts` and `steps`.
        """
        cells = self.groups if len(self.groups) > 1 else ()
        return Examination(held_out.starts, held_out.steps, cells)
