"""Jobs done in order on a separate thread, so that the training does not wait for the disk."""

import queue
import threading
from collections.abc import Callable
from types import TracebackType
from typing import Self

Job = Callable[[], None]


class Background:
    """Queue of jobs that are done one after another, in the order of their submission.

    A job that fails is the last: its error is raised by the next `submit`, or by `close`, and the
    waiting jobs are dropped. Leaving the context waits for the remaining jobs, also when the run
    was interrupted.

    Args:
        waiting: number of jobs that may wait; `submit` blocks a further one until there is room.
    """

    def __init__(self, waiting: int = 2) -> None:
        self._jobs: queue.Queue[Job | None] = queue.Queue(waiting)
        self._error: BaseException | None = None
        # A daemon: a second Ctrl-C ends the process at once, and damages no file.
        self._thread = threading.Thread(target=self._work, name="background", daemon=True)
        self._thread.start()

    def submit(self, job: Job) -> None:
        """Queue a job; the values that it reads must not change until it is done.

        Raises:
            Exception: an earlier job failed with this error.
        """
        self._raise()
        self._jobs.put(job)

    def close(self) -> None:
        """Wait until all jobs are done.

        Raises:
            Exception: a job failed with this error.
        """
        if self._thread.is_alive():
            self._jobs.put(None)
            self._thread.join()
        self._raise()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()

    def _raise(self) -> None:
        error, self._error = self._error, None
        if error is not None:
            raise error

    def _work(self) -> None:
        broken = False
        while (job := self._jobs.get()) is not None:
            if broken:
                continue
            try:
                job()
            except BaseException as error:  # kept, and raised where the training waits
                self._error, broken = error, True
