"""The one place that names the tasks."""

from typing import Any

from jaxleas.configuration import Registry
from jaxleas.envs.environment import Task
from jaxleas.types import InputError

DEFAULT_TASK = "steering"
"""Task of configurations that name no task: they were written when there was only one."""


def _require_task(name: str, item: Any) -> None:
    if not (isinstance(item, type) and issubclass(item, Task)):
        raise InputError(
            f"{name} is no task: derive a class from jaxleas.envs.environment.Task, as"
            " docs/your_own.md shows"
        )


PAGES: Registry[Any] = Registry("page of a task", {"steering": "jaxleas.viewer.web_page:page_of"})
"""Pages on which a task's exported policy runs in a browser, without a server."""

TASKS: Registry[type[Task]] = Registry(
    "task", {"steering": "jaxleas.envs.steering.task:Steering"}, _require_task
)
