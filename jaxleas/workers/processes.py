"""Workers: one function for many tasks, in this process or in several that stay alive."""

import os
import signal
import traceback
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from multiprocessing import get_all_start_methods, get_context
from multiprocessing.connection import Connection, wait
from multiprocessing.context import ForkServerContext, SpawnContext
from typing import Any, Protocol, TypeVar

from jaxleas.types import InputError, JaxleasError

Task = TypeVar("Task")
Answer = TypeVar("Answer")
MOST_DEATHS = 3
"""Number of workers that die on the same task before it is given up."""
_THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")


class WorkerError(JaxleasError):
    """A task cannot be done: every worker that tries dies."""

    exit_code = 1


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
        self._team: list[_Worker] = []

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
        busy: dict[Connection, tuple[_Worker, int]] = {}
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
        busy: "dict[Connection, tuple[_Worker, int]]",
    ) -> None:
        """Give every idle worker a task, and start more workers if there are tasks for them."""
        idle = [worker for worker in self._team if worker.connection not in busy]
        while waiting and (idle or len(self._team) < self.count):
            if idle:
                worker = idle.pop()
            else:
                worker = _Worker(self._preload)
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


class _Worker:
    """One process and the pipe to it."""

    def __init__(self, preload: Sequence[str]) -> None:
        context = _context(preload)
        self.connection, theirs = context.Pipe()
        self.process = context.Process(target=_work, args=(theirs,), daemon=True)
        with _one_thread_each():
            self.process.start()
        theirs.close()

    def take(self, function: Callable[[Any], Any], task: Any) -> bool:
        """Send a task; return whether the process was alive to take it."""
        try:
            self.connection.send((function, task))
        except OSError:
            self.kill()
            return False
        return True

    def answer(self) -> tuple[Any] | None:
        """Return the worker's answer; None if it died instead."""
        try:
            answer, error, story = self.connection.recv()
        except (EOFError, OSError):
            self.kill()
            return None
        if error is not None:
            error.add_note(story)
            raise error
        return (answer,)

    def kill(self) -> None:
        """End the process now."""
        self.process.kill()
        self.process.join()
        self.connection.close()


def _context(preload: Sequence[str]) -> ForkServerContext | SpawnContext:
    """Return the way to start processes: a fork server that imports the modules once for all.

    Its forks start in milliseconds and are safe: the server itself starts neither JAX nor threads.
    """
    if "forkserver" not in get_all_start_methods():
        return get_context("spawn")
    context = get_context("forkserver")
    context.set_forkserver_preload(list(preload))
    return context


def _work(connection: Connection) -> None:
    """Do tasks until the other end of the pipe closes."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the parent handles Ctrl-C
    try:
        while True:
            function, task = connection.recv()
            try:
                reply = function(task), None, ""
            except Exception as error:
                reply = None, _sendable(error), f"in a worker:\n{traceback.format_exc()}"
            connection.send(reply)
    except (EOFError, OSError):
        return


def _sendable(error: Exception) -> Exception:
    return error if isinstance(error, JaxleasError) else RuntimeError(repr(error))


def _require_alive(deaths: int, worker: _Worker) -> None:
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


def require_count(count: int) -> None:
    """Refuse a number of workers below one."""
    if count < 1:
        raise InputError(f"--processes is {count}; give 1 or more")


@contextmanager
def _one_thread_each() -> Iterator[None]:
    """Let each worker's linear algebra use one thread: the processes are the parallelism."""
    before = {name: os.environ.get(name) for name in _THREADS}
    os.environ.update(dict.fromkeys(_THREADS, "1"))
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                os.environ.pop(name, None)
            else:
                os.environ[name] = value
