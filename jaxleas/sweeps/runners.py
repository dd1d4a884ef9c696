"""Runners of a sweep's jobs: processes on this machine, or a Ray cluster."""

from collections.abc import Iterator, Sequence
from functools import partial
from pathlib import Path
from typing import Protocol

from jaxleas.sweeps.job import ALLOW
from jaxleas.sweeps.processes import Processes
from jaxleas.sweeps.ray_jobs import RayJobs, work_in_ray
from jaxleas.types import InputError


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
        return RayJobs(count, partial(work_in_ray, allow=tuple(allow)))
    named = [word for name in allow for word in (ALLOW, name)]
    return Processes(count, options=named)
