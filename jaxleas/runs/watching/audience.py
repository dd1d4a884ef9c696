"""All watchers of a run, each with its own thread."""

import queue
import threading
import time
from collections.abc import Callable, Mapping
from functools import partial
from typing import Any

from jaxleas.runs.watching.watcher import Status, Watcher

MOST_WAITING = 10_000
"""Number of rows that wait for a slow watcher; it never receives later ones."""
FAREWELL = 30.0
"""Time that the watchers have to finish when the run ends [s]."""

Call = Callable[[], None]


class Audience:
    """Group of watchers that receive what the run logs; it never waits for them or fails with them.

    A watcher that fails is named in one sentence and receives nothing more. A watcher that is too
    slow loses rows, which is reported once. `metrics.jsonl` holds every row in any case.
    """

    def __init__(
        self,
        watchers: Mapping[str, Watcher],
        say: Callable[[str], None],
        farewell: float = FAREWELL,
    ) -> None:
        """Prepare a thread for each watcher.

        Args:
            watchers: watchers by name.
            say: function that is called with a sentence about a watcher that fails, from other
                threads.
            farewell: time that all of them have to finish at the end [s].
        """
        self._seats = [_Seat(name, watcher, say) for name, watcher in watchers.items()]
        self._say = say
        self._farewell = farewell

    def begin(self, config: Mapping[str, Any], name: str, resumed_after: int | None) -> None:
        """Notify all watchers that the run begins."""
        for seat in self._seats:
            seat.tell(partial(seat.watcher.begin, config, name, resumed_after))

    def row(self, step: int, metrics: Mapping[str, float]) -> None:
        """Send a row to all watchers."""
        for seat in self._seats:
            seat.tell(partial(seat.watcher.row, step, metrics))

    def end(self, status: Status) -> None:
        """Notify all watchers that the run is over; wait a moment for them to finish."""
        deadline = time.monotonic() + self._farewell
        for seat in self._seats:
            seat.tell(partial(seat.watcher.end, status))
            seat.close()
        for seat in self._seats:
            if not seat.leave(max(deadline - time.monotonic(), 0.0)):
                self._say(
                    f"{seat.name} is not done after {self._farewell:g} s and is left alone:"
                    " metrics.jsonl holds every row"
                )


class _Seat:
    """One watcher, its thread and the calls still to be made."""

    def __init__(self, name: str, watcher: Watcher, say: Callable[[str], None]) -> None:
        self.name, self.watcher = name, watcher
        self._say = say
        self._waiting: queue.Queue[Call | None] = queue.Queue(MOST_WAITING)
        self._gone = self._late = False
        # A daemon: a watcher that hangs must not keep the process from ending.
        self._thread = threading.Thread(target=self._follow, name=f"watch {name}", daemon=True)
        self._thread.start()

    def tell(self, call: Call) -> None:
        if self._gone:
            return
        try:
            self._waiting.put_nowait(call)
        except queue.Full:
            if not self._late:
                self._late = True
                self._say(f"{self.name} cannot follow and loses rows: metrics.jsonl holds them")

    def close(self) -> None:
        """Mark the end of the calls, even for a watcher whose queue is full."""
        while self._thread.is_alive():
            try:
                return self._waiting.put_nowait(None)
            except queue.Full:
                self._waiting.get_nowait()

    def leave(self, seconds: float) -> bool:
        self._thread.join(seconds)
        return not self._thread.is_alive()

    def _follow(self) -> None:
        while (call := self._waiting.get()) is not None:
            try:
                call()
            except Exception as error:  # a third-party client may raise anything
                self._gone = True
                reason = " ".join(str(error).split())[:200] or type(error).__name__
                self._say(
                    f"{self.name} failed and receives nothing more: {reason} (training continues,"
                    " metrics.jsonl holds every row)"
                )
                return
