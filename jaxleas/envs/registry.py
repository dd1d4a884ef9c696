"""The one place that names the tasks."""

from typing import Any

from jaxleas.configuration import Registry
from jaxleas.envs.environment import Task
from jaxleas.envs.own_task import require_task

DEFAULT_TASK = "steering"
"""Task of configurations that name no task: they were written when there was only one."""


PAGES: Registry[Any] = Registry("page of a task", {"steering": "jaxleas.viewer.web_page:page_of"})
"""Pages on which a task's exported policy runs in a browser, without a server."""

TASKS: Registry[type[Task]] = Registry(
    "task",
    {
        "steering": "jaxleas.envs.steering.task:Steering",
        "gait_planning": "jaxleas.envs.gait_planning.task:GaitPlanning",
    },
    require_task,
)
