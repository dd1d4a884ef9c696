"""One worker process and the pipe to it."""

import os
import signal
import traceback
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from multiprocessing import get_all_start_methods, get_context
from multiprocessing.connection import Connection
from multiprocessing.context import ForkServerContext, SpawnContext
from typing import Any

from jaxleas.types import JaxleasError

_THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")


class WorkerProcess:
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
