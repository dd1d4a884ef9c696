"""Runners of a sweep's jobs: processes on this machine, or a Ray cluster."""

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from importlib import import_module
from pathlib import Path
from typing import Any, Protocol

from jaxleas.sweeps.job import ALLOW, LIFELINE, work
from jaxleas.types import InputError
from jaxleas.workers import RayWorkers

_COMMAND = (sys.executable, "-m", "jaxleas.sweeps.job")
GRACE = 60.0  # time for workers to save after being asked to stop [s]


class Runner(Protocol):
    """A runner of jobs, which are files of `job.write_job`."""

    def start(self, job: Path) -> None:
        """Begin a job."""
        ...

    def ended(self) -> Iterator[tuple[Path, str]]:
        """Yield the jobs that ended since the last call, each with the last words of its worker."""
        ...

    @property
    def free(self) -> int:
        """Return the number of further jobs that can begin now."""
        ...

    def close(self) -> None:
        """End the jobs that still run; they can be continued later."""
        ...


@dataclass(frozen=True)
class _Child:
    process: subprocess.Popen
    job: Path


class Processes:
    """Runner with one process per job; the processes end when this one does, however it ends.

    Args:
        count: number of jobs at the same time.
        command: command that does the job whose file is its next argument.
        options: further arguments of the command.
    """

    def __init__(
        self, count: int, command: Sequence[str] = _COMMAND, options: Sequence[str] = ()
    ) -> None:
        self.count = count
        self._command = tuple(command)
        self._options = tuple(options)
        self._children: list[_Child] = []

    @property
    def pids(self) -> list[int]:
        """Process ids of the workers."""
        return [child.process.pid for child in self._children]

    @property
    def free(self) -> int:
        """Return the number of further jobs that can begin now."""
        return self.count - len(self._children)

    def start(self, job: Path) -> None:
        """Begin a job."""
        with log_of(job).open("ab") as log:
            process = subprocess.Popen(
                [*self._command, str(job), LIFELINE, *self._options],
                stdin=subprocess.PIPE,  # closes when this process ends: the child then ends too
                stdout=log,
                stderr=subprocess.STDOUT,
                start_new_session=True,  # Ctrl-C is handled here
                env=os.environ | {"CI": "true", "PYTHONUNBUFFERED": "1"},
            )
        self._children.append(_Child(process, job))

    def ended(self) -> Iterator[tuple[Path, str]]:
        """Yield the jobs that ended since the last call."""
        for child in list(self._children):
            code = child.process.poll()
            if code is not None:
                self._children.remove(child)
                _close(child)
                yield child.job, f"exit code {code}; see {log_of(child.job)}"

    def close(self) -> None:
        """Ask the workers to save and stop; end those that do not."""
        for child in self._children:
            child.process.send_signal(signal.SIGTERM)
        until = time.monotonic() + GRACE
        for child in self._children:
            try:
                child.process.wait(max(0.0, until - time.monotonic()))
            except subprocess.TimeoutExpired:
                child.process.kill()
                child.process.wait()
            _close(child)
        self._children = []


class RayJobs:
    """Runner with one Ray task per job, on the cluster that RAY_ADDRESS names, or on this machine.

    All machines need this package, and the sweep's folder under the same path. The conductor, not
    Ray, restarts the job of a dead worker, so that deaths are counted in one place.
    """

    def __init__(self, count: int, function: Callable[[str], str] | None = None) -> None:
        """Connect to Ray.

        Args:
            count: number of jobs at the same time.
            function: function that does the job in a given file, and returns its last words.

        Raises:
            InputError: Ray is not installed or does not answer.
        """
        self._cluster = RayWorkers(count)
        self._ray: Any = import_module("ray")
        # A separate process for every job: a process chooses JAX's devices only once.
        options = {"max_retries": 0, "num_cpus": 1, "max_calls": 1}
        self._remote = self._ray.remote(**options)(function or _work_in_ray)
        self.count = count
        self._flying: dict[Any, Path] = {}

    @property
    def free(self) -> int:
        """Return the number of further jobs that can begin now."""
        return self.count - len(self._flying)

    def start(self, job: Path) -> None:
        """Begin a job."""
        self._flying[self._remote.remote(str(job))] = job

    def ended(self) -> Iterator[tuple[Path, str]]:
        """Yield the jobs that ended since the last call."""
        if not self._flying:
            return
        done, _ = self._ray.wait(list(self._flying), num_returns=len(self._flying), timeout=0.0)
        for reference in done:
            job = self._flying.pop(reference)
            try:
                yield job, self._ray.get(reference)
            except self._ray.exceptions.RayError as error:
                yield job, str(error).strip().splitlines()[0]

    def close(self) -> None:
        """End the workers; what they saved stays on disk."""
        for reference in self._flying:
            self._ray.cancel(reference, force=True)
        self._flying = {}
        self._cluster.close()


def _work_in_ray(job: str, allow: Sequence[str] = ()) -> str:
    """Do a job in a worker of Ray; return its last words."""
    try:
        work(job, allow)
    except Exception as error:
        return f"{type(error).__name__}: {error}"
    return ""


def engage(kind: str, count: int, allow: Sequence[str] = ()) -> Runner:
    """Return a runner of several jobs at the same time.

    Args:
        kind: "processes" or "ray".
        count: number of jobs at the same time.
        allow: user's own code that may be run, as MODULE:CLASS.

    Raises:
        InputError: the count is below 1, or Ray cannot be used.
    """
    if count < 1:
        raise InputError(f"--parallel is {count}; give 1 or more")
    if kind == "ray":
        return RayJobs(count, partial(_work_in_ray, allow=tuple(allow)))
    named = [word for name in allow for word in (ALLOW, name)]
    return Processes(count, options=named)


def log_of(job: Path) -> Path:
    """Return the file with the output of a job's worker."""
    return job.with_suffix(".log")


def _close(child: _Child) -> None:
    if child.process.stdin is not None:
        child.process.stdin.close()
