"""Workers on a Ray cluster: the same tasks on any number of machines (an extra)."""

import os
from collections.abc import Callable, Iterator, Sequence
from importlib import import_module
from typing import Any

from jaxleas.types import InputError
from jaxleas.workers.processes import MOST_DEATHS, WorkerError
from jaxleas.workers.workers import Answer, Task, require_count


class RayWorkers:
    """Workers on Ray: on the cluster that RAY_ADDRESS names, or on this machine.

    Ray itself repeats the task of a worker that dies. All machines need this package, and for
    verdict files the same folders under the same paths.

    Attributes:
        count: number of tasks done at the same time.
    """

    def __init__(self, count: int | None = None) -> None:
        """Connect to Ray, or start it here.

        Args:
            count: number of tasks at the same time; None: the cluster's number of processors.

        Raises:
            InputError: Ray is not installed, does not answer, or the count is below 1.
        """
        if count is not None:
            require_count(count)
        self._ray = require_ray()
        self._started = not self._ray.is_initialized()
        if self._started:
            self._start(count)
        self.count = count or max(1, int(self._ray.cluster_resources().get("CPU", 1)))

    def run(
        self, function: Callable[[Task], Answer], tasks: Sequence[Task]
    ) -> Iterator[tuple[int, Answer]]:
        """Yield (index of the task, answer) as tasks are done, each of them once.

        Raises:
            WorkerError: workers repeatedly die on one task.
        """
        ray = self._ray
        remote = ray.remote(function).options(max_retries=MOST_DEATHS - 1, num_cpus=1)
        begun, flying = 0, {}
        try:
            while begun < len(tasks) or flying:
                while begun < len(tasks) and len(flying) < self.count:
                    flying[remote.remote(tasks[begun])] = begun
                    begun += 1
                done, _ = ray.wait(list(flying), num_returns=1)
                index = flying.pop(done[0])
                yield index, self._answer(done[0])
        finally:
            for waiting in flying:  # interrupted: their answers are no longer needed
                ray.cancel(waiting, force=True)

    def close(self) -> None:
        """Disconnect from Ray, if this object connected to it."""
        if self._started:
            self._ray.shutdown()

    def _start(self, count: int | None) -> None:
        here = "RAY_ADDRESS" not in os.environ
        try:
            self._ray.init(
                num_cpus=count if here else None,
                include_dashboard=False if here else None,
                log_to_driver=False,
            )
        except Exception as error:  # Ray also raises bare exceptions, when a node is slow to start
            raise InputError(f"Ray cannot be reached or started: {error}") from error

    def _answer(self, reference: Any) -> Any:
        errors = self._ray.exceptions
        try:
            return self._ray.get(reference)
        except errors.RayTaskError as error:
            raise error.cause from error
        except (errors.WorkerCrashedError, errors.OutOfMemoryError) as error:
            raise WorkerError(f"{MOST_DEATHS} workers died over the same task") from error


def require_ray() -> Any:
    """Return the module `ray`.

    Raises:
        InputError: Ray is not installed.
    """
    try:
        ray = import_module("ray")
        import_module("ray.exceptions")
    except ImportError as error:
        raise InputError("workers on Ray need the extra: pip install 'jaxleas[ray]'") from error
    return ray
