"""Jobs of a sweep in processes of this machine."""

import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from jaxleas.sweeps.job import LIFELINE
from jaxleas.sweeps.job_files import log_of

_COMMAND = (sys.executable, "-m", "jaxleas.sweeps.job")
GRACE = 60.0  # time for workers to save after being asked to stop [s]


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


def _close(child: _Child) -> None:
    if child.process.stdin is not None:
        child.process.stdin.close()
