"""Workers on a Ray cluster: the same tasks, on as many machines as there are (an extra)."""

import os
from collections.abc import Callable, Iterator, Sequence
from importlib import import_module
from typing import Any

from jaxleas.types.errors import InputError
from jaxleas.workers.processes import MOST_DEATHS, Answer, Task, WorkerError, require_count


class RayWorkers:
    """Does tasks on Ray: the cluster that RAY_ADDRESS names, or this machine.

    Ray itself does the task of a worker that dies again. All machines need this package, and for
    verdict files the same folders under the same names.

    Attributes:
        count: tasks at the same time.
    """

    def __init__(self, count: int | None = None) -> None:
        """Connect to Ray, or start it here.

        Args:
            count: tasks at the same time; as many as the cluster has processors if None.

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
        """Yield (index of the task, answer) as tasks are done: each of them once.

        Raises:
            WorkerError: workers die over one task again and again.
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
            for waiting in flying:  # interrupted: nobody waits for these any more
                ray.cancel(waiting, force=True)

    def close(self) -> None:
        """Leave Ray, if we came to it."""
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
        except Exception as error:  # Ray raises bare ones too, when a node is slow to start
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
        InputError: it is not installed.
    """
    try:
        ray = import_module("ray")
        import_module("ray.exceptions")
    except ImportError as error:
        raise InputError("workers on Ray need the extra: pip install 'jaxleas[ray]'") from error
    return ray
