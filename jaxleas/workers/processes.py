"""Worker processes that stay alive, and the choice between them and this process."""

from collections import deque
from collections.abc import Callable, Iterator, Sequence
from multiprocessing.connection import Connection, wait
from typing import Any

from jaxleas.types import JaxleasError
from jaxleas.workers.worker_process import WorkerProcess
from jaxleas.workers.workers import Answer, Here, Task, Workers, require_count

MOST_DEATHS = 3
"""Number of workers that die on the same task before it is given up."""


class WorkerError(JaxleasError):
    """A task cannot be done: every worker that tries dies."""

    exit_code = 1


class ProcessWorkers:
    """Worker processes that are started once, when there are first tasks, and kept.

    A worker that dies is replaced, and its task is done again by any free worker. Ctrl-C
    ends the workers that are busy; the next `run` starts others. Programs that use this need the
    usual `if __name__ == "__main__":`, since workers import the main module.

    Attributes:
        count: number of processes.
    """

    def __init__(self, count: int, preload: Sequence[str] = ()) -> None:
        """Prepare the workers; none is started yet.

        Args:
            count: number of processes.
            preload: modules that a fork server imports once for all processes: they must start
                neither JAX nor threads.
        """
        require_count(count)
        self.count = count
        self._preload = tuple(preload)
        self._team: list[WorkerProcess] = []

    @property
    def pids(self) -> list[int]:
        """Process ids of the living workers."""
        return [worker.process.pid for worker in self._team if worker.process.pid is not None]

    def run(
        self, function: Callable[[Task], Answer], tasks: Sequence[Task]
    ) -> Iterator[tuple[int, Answer]]:
        """Yield (index of the task, answer) as tasks are done, each of them once.

        Raises:
            WorkerError: workers repeatedly die on one task.
        """
        waiting, deaths = deque(range(len(tasks))), [0] * len(tasks)
        busy: dict[Connection, tuple[WorkerProcess, int]] = {}
        try:
            while waiting or busy:
                self._hand_out(function, tasks, waiting, busy)
                for connection in wait(list(busy)):
                    worker, index = busy.pop(connection)  # type: ignore[call-overload]
                    answer = worker.answer()
                    if answer is None:
                        self._team.remove(worker)
                        deaths[index] += 1
                        _require_alive(deaths[index], worker)
                        waiting.appendleft(index)
                        continue
                    yield index, answer[0]
        finally:
            for worker, _ in busy.values():  # interrupted: their answers are no longer needed
                worker.kill()
                self._team.remove(worker)

    def _hand_out(
        self,
        function: Callable[[Task], Any],
        tasks: Sequence[Task],
        waiting: deque[int],
        busy: "dict[Connection, tuple[WorkerProcess, int]]",
    ) -> None:
        """Give every idle worker a task, and start more workers if there are tasks for them."""
        idle = [worker for worker in self._team if worker.connection not in busy]
        while waiting and (idle or len(self._team) < self.count):
            if idle:
                worker = idle.pop()
            else:
                worker = WorkerProcess(self._preload)
                self._team.append(worker)
            index = waiting.popleft()
            if worker.take(function, tasks[index]):
                busy[worker.connection] = worker, index
            else:  # it died while it was idle
                self._team.remove(worker)
                waiting.appendleft(index)

    def close(self) -> None:
        """End the workers."""
        for worker in self._team:
            worker.kill()
        self._team = []


def _require_alive(deaths: int, worker: WorkerProcess) -> None:
    if deaths >= MOST_DEATHS:
        raise WorkerError(
            f"{deaths} workers died over the same task, the last with exit code"
            f" {worker.process.exitcode} (-9 is often too little memory: give fewer --processes)"
        )


def workers_for(count: int, preload: Sequence[str] = ()) -> Workers:
    """Return this process for one worker, and processes for several.

    Args:
        count: number of tasks done at the same time.
        preload: modules that are imported once for all processes (`ProcessWorkers`).

    Raises:
        InputError: the count is below 1.
    """
    require_count(count)
    return Here() if count == 1 else ProcessWorkers(count, preload)
