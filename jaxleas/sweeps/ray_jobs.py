"""Jobs of a sweep as tasks of a Ray cluster."""

from collections.abc import Callable, Iterator, Sequence
from importlib import import_module
from pathlib import Path
from typing import Any

from jaxleas.sweeps.job import work
from jaxleas.workers import RayWorkers


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
        self._remote = self._ray.remote(**options)(function or work_in_ray)
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


def work_in_ray(job: str, allow: Sequence[str] = ()) -> str:
    """Do a job in a worker of Ray; return its last words."""
    try:
        work(job, allow)
    except Exception as error:
        return f"{type(error).__name__}: {error}"
    return ""
