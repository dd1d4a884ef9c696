"""What any task is: the one protocol that learning, sweeps and export know.

A task is a class derived from `Task`, and a section of the configuration derived from `TaskConfig`.
Its methods are pure and work on many robots at once: every array is [robots, ...]. What restarts
episodes, mirrors experience, writes policies and exports them are functions over this protocol.
"""

from abc import ABC, abstractmethod
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from typing import Annotated, Any, ClassVar, Self

import jax
import jax.numpy as jnp
from flax import struct
from jax import Array
from jaxtyping import Bool, Float, Int
from pydantic import Field

from jaxleas.configuration.bounds import Count
from jaxleas.configuration.strict import Strict
from jaxleas.envs.signature import Signature
from jaxleas.terrain.seeds import MAX_TRAINING_SEED

FORMAT = 1
"""Of what an exported policy says about itself."""


class TaskConfig(Strict, ABC):
    """A task's section of a run's configuration: `env`.

    Attributes:
        swept: fields that are numbers in the compiled program and change no shape in it, dotted:
            members of a population may differ in them.
        moved: former names of fields, of any section of a run: {"ppo.x": "env.y"}; files that use
            them still open.
    """

    swept: ClassVar[tuple[str, ...]] = ()
    moved: ClassVar[Mapping[str, str]] = {}

    task: str
    """Name of the task, or MODULE:CLASS of one's own."""

    def pinned(self) -> Self:
        """Return the same task, each file that it names by its absolute path and its digest.

        A run folder keeps it in this form: a resumed run finds the files from any folder, and
        notices when one has changed.

        Raises:
            InputError: a file is missing.
        """
        return self

    @abstractmethod
    def signature(self) -> Signature:
        """Return what a policy is shown and what it answers; the same at every call."""

    def describe(self) -> dict[str, Any]:
        """Return what an exported policy says about itself, as plain JSON values by name."""
        signature = self.signature()
        parts = [{"name": part.name, "shape": list(part.shape)} for part in signature.seen]
        return {
            "format": FORMAT,
            "task": self.task,
            "observation": parts,
            "command": [{"name": head.name} for head in signature.heads],
            "task_config": self.model_dump(mode="json"),
        }


class WorldsConfig(Strict):
    """What a task's robots train in: section `terrain` of a run's configuration."""

    arenas: Count = 64
    """Number of random arenas."""
    first_seed: Annotated[int, Field(ge=0, le=MAX_TRAINING_SEED)] = 0
    """Arena i is generated from seed first_seed + i; evaluation uses seeds beyond these."""

    def pinned(self) -> Self:
        """Return the same worlds, each file that they name by its absolute path and its digest."""
        return self


@struct.dataclass
class Starts:
    """Candidates for the first states of episodes.

    Attributes:
        state: of each candidate: a pytree of arrays [candidates, ...].
        valid: whether an episode may begin there.
        group: number of the group that each belongs to, an index of `Task.groups`.
    """

    state: Any
    valid: Bool[Array, " candidates"]
    group: Int[Array, " candidates"]


@struct.dataclass
class StepResult:
    """What a step tells, besides the next state.

    Attributes:
        reward: for the step.
        terminated: the episode failed: it ends, and nothing follows.
        truncated: the episode was cut: its future has a value, only unseen.
        reached: the goal sought during the step was reached.
        measures: further numbers by name, whose means are logged as `walk/NAME`.
    """

    reward: Float[Array, "*batch"]
    terminated: Bool[Array, "*batch"]
    truncated: Bool[Array, "*batch"]
    reached: Bool[Array, "*batch"]
    measures: dict[str, Float[Array, "*batch"]] = struct.field(default_factory=dict, kw_only=True)


@dataclass(frozen=True)
class Examination:
    """How success is measured during training, on worlds that are never trained on.

    Attributes:
        starts: number of episodes; each is walked without chance until it reaches, fails, or its
            time is up.
        steps: most steps of each.
        cells: groups of starts whose success is told apart, besides that of all.
    """

    starts: int
    steps: int
    cells: tuple[str, ...] = ()


class Task(ABC):
    """One task for one configuration; it holds constants only.

    Arrays are JAX's and methods are traced, unless `on_host`: then they are NumPy's, methods are
    called as they are (a simulator in C may hide behind them), and each `key` is a
    `numpy.random.Generator`.

    Attributes:
        Config: the section `env`.
        Worlds: the section `terrain`.
        on_host: whether its methods work in NumPy.
        is_disturbed: whether `draw_disturbances` draws anything.
        groups: names of the groups of starts.
        config: configuration of the task.
        worlds: configuration of what its robots train in.
        signature: what a policy is shown and what it answers.
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
            worlds: configuration of what its robots train in, of type `Worlds`.
        """
        self.config = config
        self.worlds = worlds
        self.signature: Signature = config.signature()

    @classmethod
    def make(cls, config: Any, worlds: Any, allow: Collection[str] = ()) -> Self:
        """Return the task that a configuration asks for.

        Args:
            config: configuration of the task.
            worlds: configuration of what its robots train in.
            allow: code of the user's own that may be run, each MODULE:CLASS.
        """
        del allow
        return cls(config, worlds)

    def require_worlds(self) -> None:  # noqa: B027 (most tasks have nothing to refuse)
        """Refuse worlds that cannot be made, as far as that can be seen quickly.

        Asked before a run folder is made.

        Raises:
            InputError: one sentence with file and key.
        """

    @abstractmethod
    def make_world(self, seeds: Sequence[int], examined: bool) -> Any:
        """Return what the robots stand in, a pytree of arrays (NumPy's, or JAX's).

        Args:
            seeds: seeds of its arenas; those of training and examination never meet.
            examined: whether it is for the examination: then every start should have a goal that
                can be reached.
        """

    @abstractmethod
    def draw_starts(self, world: Any, key: Any, count: int, examined: bool = False) -> Starts:
        """Draw candidates for the first states of episodes, anew at every call.

        Args:
            world: of `make_world`.
            key: randomness, consumed here.
            count: number of candidates.
            examined: whether they are for the examination.
        """

    def stagger(self, state: Any, key: Any) -> Any:
        """Return first states as if their episodes had begun at different times.

        Episodes that end at different times make no wave of restarts.

        Args:
            state: of all robots, at the beginning of their episodes.
            key: randomness, consumed here.
        """
        del key
        return state

    def draw_disturbances(self, key: Any, shape: tuple[int, ...]) -> Any:
        """Draw the chance of a whole roll-out in bulk: a pytree of arrays [*shape, ...].

        Args:
            key: randomness, consumed here.
            shape: steps and robots.
        """
        del key, shape
        return ()

    def weights(self, numbers: Mapping[str, Any], progress: Any) -> Any:
        """Return the numbers that rewards are made with, a pytree of scalars.

        Args:
            numbers: value of each field that `Config.swept` names.
            progress: share of the training that is done, 0 to 1.
        """
        del progress
        return dict(numbers)

    @abstractmethod
    def advance(
        self, world: Any, weights: Any, state: Any, action: Any, disturbance: Any
    ) -> tuple[Any, StepResult]:
        """Advance one time step; return the next state and what the step tells.

        Args:
            world: of `make_world`.
            weights: of `weights`.
            state: of the episodes.
            action: what the heads answer: by name, or of the only head alone; real numbers in
                [-1, 1] (`command` gives physical units), choices as indices.
            disturbance: one step's part of `draw_disturbances`.
        """

    @abstractmethod
    def look(self, world: Any, state: Any) -> Any:
        """Return what is seen in a state, in physical units: by part, or the only part alone.

        Args:
            world: of `make_world`.
            state: of the episodes.
        """

    def command(self, action: Any) -> Any:
        """Return an action in physical units."""
        return self.signature.command(action)

    def examination(self, held_out: Any) -> Examination:
        """Return how success is measured during training.

        Args:
            held_out: section of the run's configuration: `starts` and `steps`.
        """
        cells = self.groups if len(self.groups) > 1 else ()
        return Examination(held_out.starts, held_out.steps, cells)


def select(flag: Bool[Array, " robots"], chosen: Any, other: Any) -> Any:
    """Return, robot by robot, `chosen` where the flag is set and `other` elsewhere."""

    def pick(left: Array, right: Array) -> Array:
        return jnp.where(flag.reshape(flag.shape + (1,) * (left.ndim - flag.ndim)), left, right)

    return jax.tree.map(pick, chosen, other)
