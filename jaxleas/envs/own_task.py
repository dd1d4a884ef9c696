"""What can be seen of a user's own task class before anything is made of it."""

import inspect
from typing import Any

from jaxleas.configuration import require_field
from jaxleas.envs.environment import Task
from jaxleas.envs.task_config import TaskConfig, WorldsConfig
from jaxleas.types import InputError


def require_task(name: str, item: Any) -> None:
    """Refuse what is not a task, and a task that leaves out what every task has.

    Args:
        name: name of the task, MODULE:CLASS.
        item: object found under that name.

    Raises:
        InputError: one sentence says what is missing or wrong.
    """
    if not (isinstance(item, type) and issubclass(item, Task)):
        raise InputError(
            f"{name} is not a task: derive a class from jaxleas.envs.Task, as"
            " docs/your_own_task.md shows"
        )
    _require_complete(name, item)
    for section, base in (("Config", TaskConfig), ("Worlds", WorldsConfig)):
        found = getattr(item, section, None)
        if not (isinstance(found, type) and issubclass(found, base)):
            raise InputError(
                f"the task {name} has the {section} {found!r}; give a class derived from"
                f" jaxleas.envs.{base.__name__}"
            )
        _require_complete(f"{name}.{section}", found)
    _require_names(f"the task {name}: groups", item.groups)
    _require_names(f"the task {name}: {section_of(item)}.swept", item.Config.swept, least=0)
    for field in item.Config.swept:
        require_field(item.Config, field, f"the task {name}: {section_of(item)}.swept")


def section_of(task: type[Task]) -> str:
    """Return the name of the class of a task's configuration."""
    return task.Config.__name__


def _require_complete(name: str, item: type) -> None:
    missing = sorted(getattr(item, "__abstractmethods__", ()))
    if missing and inspect.isabstract(item):
        raise InputError(f"{name} leaves out {' and '.join(missing)}: every such class needs it")


def _require_names(what: str, names: Any, least: int = 1) -> None:
    is_tuple = isinstance(names, tuple) and all(isinstance(name, str) for name in names)
    if not is_tuple or len(names) < least or len(set(names)) < len(names):
        raise InputError(f'{what} is {names!r}; give a tuple of different names, as in ("one",)')
