"""Jobs done in order on a thread of their own, so that the training need not wait for the disk."""

import queue
import threading
from collections.abc import Callable
from types import TracebackType
from typing import Self

Job = Callable[[], None]


class Background:
    """Does jobs one after the other, in the order in which they came.

    A job that fails is the last: its error comes up at the next `submit`, or at `close`, and the
    jobs that wait are dropped. Leaving the context waits for what is under way, also when the run
    was interrupted.

    Args:
        waiting: jobs that may wait; a further one waits in `submit` until there is room.
    """

    def __init__(self, waiting: int = 2) -> None:
        self._jobs: queue.Queue[Job | None] = queue.Queue(waiting)
        self._error: BaseException | None = None
        # A daemon: a second Ctrl-C ends the process at once, and no file suffers by it.
        self._thread = threading.Thread(target=self._work, name="background", daemon=True)
        self._thread.start()

    def submit(self, job: Job) -> None:
        """Have a job done; what it reads must not change until then.

        Raises:
            Exception: that of an earlier job.
        """
        self._raise()
        self._jobs.put(job)

    def close(self) -> None:
        """Wait until all is done.

        Raises:
            Exception: that of a job.
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
            except BaseException as error:  # not swallowed: raised where the training waits
                self._error, broken = error, True
