"""What workers are, and this process as the only one."""

from collections.abc import Callable, Iterator, Sequence
from typing import Protocol, TypeVar

from jaxleas.types import InputError

Task = TypeVar("Task")
Answer = TypeVar("Answer")


class Workers(Protocol):
    """Workers that do tasks.

    Attributes:
        count: number of tasks done at the same time.
    """

    count: int

    def run(
        self, function: Callable[[Task], Answer], tasks: Sequence[Task]
    ) -> Iterator[tuple[int, Answer]]:
        """Yield (index of the task, answer) as tasks are done, each of them once."""
        ...

    def close(self) -> None:
        """End the workers."""
        ...


class Here:
    """Workers that do tasks in this process, one after another."""

    count = 1

    def run(
        self, function: Callable[[Task], Answer], tasks: Sequence[Task]
    ) -> Iterator[tuple[int, Answer]]:
        """Yield (index of the task, answer)."""
        for index, task in enumerate(tasks):
            yield index, function(task)

    def close(self) -> None:
        """Do nothing."""


def require_count(count: int) -> None:
    """Refuse a number of workers below one."""
    if count < 1:
        raise InputError(f"--processes is {count}; give 1 or more")
