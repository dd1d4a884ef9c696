"""The sections of a run's configuration that a task defines: its own, and that of its worlds."""

from abc import ABC, abstractmethod
from collections.abc import Mapping
from typing import Annotated, Any, ClassVar, Self

from pydantic import Field

from jaxleas.configuration import Count, Strict
from jaxleas.envs.signature import Signature
from jaxleas.terrain import MAX_TRAINING_SEED

FORMAT = 1
"""Version of the description that an exported policy carries."""


class TaskConfig(Strict, ABC):
    """A task's section of a run's configuration: `env`.

    Attributes:
        swept: dotted names of the fields that are numbers in the compiled program and change no
            shape in it: members of a population may differ in them.
        moved: former names of fields, of any section of a run: {"ppo.x": "env.y"}; files that use
            them still open.
    """

    swept: ClassVar[tuple[str, ...]] = ()
    moved: ClassVar[Mapping[str, str]] = {}

    task: str
    """Name of the task, or MODULE:CLASS of the user's own task."""

    @classmethod
    def suited(cls, stated: Mapping[str, Any]) -> dict[str, Any]:
        """Return values for a run's sections that suit what its section `env` states.

        They count where neither a file nor the command line states another: the sizes that suit
        the robot, say.

        Args:
            stated: values that files and the command line state in the section.
        """
        del stated
        return {}

    def pinned(self) -> Self:
        """Return the same task, with the absolute path and digest of each file that it names.

        A run folder keeps it in this form: a resumed run finds the files from any folder, and
        notices when one has changed.

        Raises:
            InputError: a file is missing.
        """
        return self

    @abstractmethod
    def signature(self) -> Signature:
        """Return the signature of observation and action; the same at every call."""

    def describe(self) -> dict[str, Any]:
        """Return the description that an exported policy carries, as plain JSON values by name."""
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
    """The worlds that a task's robots train in: section `terrain` of a run's configuration."""

    arenas: Count = 64
    """Number of random arenas."""
    first_seed: Annotated[int, Field(ge=0, le=MAX_TRAINING_SEED)] = 0
    """Arena i is generated from seed first_seed + i; evaluation uses seeds beyond these."""

    def pinned(self) -> Self:
        """Return the same worlds, with the absolute path and digest of each file that they name."""
        return self
