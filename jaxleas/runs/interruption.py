"""Ctrl-C and SIGTERM, held back until what is in progress is complete."""

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType, TracebackType
from typing import Self


class Interruption:
    """Context in which the first SIGINT or SIGTERM only sets `requested`.

    A second one acts as usual.

    Attributes:
        requested: whether a signal has arrived.
        number: number of that signal.
    """

    def __init__(self) -> None:
        self.requested = False
        self.number = 0
        self._previous: dict[int, object] = {}

    def __enter__(self) -> Self:
        for number in (signal.SIGINT, signal.SIGTERM):
            self._previous[number] = signal.getsignal(number)
            signal.signal(number, self._note)
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._restore()

    def _note(self, number: int, frame: FrameType | None) -> None:
        self.requested, self.number = True, number
        self._restore()

    def _restore(self) -> None:
        for number, handler in self._previous.items():
            signal.signal(number, handler)  # type: ignore[arg-type]
        self._previous = {}


@contextmanager
def interrupts_deferred() -> Iterator[None]:
    """Hold Ctrl-C and SIGTERM back until this context ends.

    For imports of libraries in C and C++: some end the whole process, by a segmentation fault at
    worst, when a KeyboardInterrupt comes while they initialise themselves.
    """
    if threading.current_thread() is not threading.main_thread():
        yield  # no signal is handled in this thread
        return
    with Interruption() as held:
        yield
    if held.requested:
        signal.raise_signal(held.number)
