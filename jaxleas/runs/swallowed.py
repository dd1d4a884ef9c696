"""Ctrl-C at a moment when Python discards its exception: the signal is sent again."""

import _thread
import signal
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

PAUSE = 0.02
"""Pause between a lost interrupt and the next try [s]; the callback has ended by then."""


@contextmanager
def interrupts_kept() -> Iterator[None]:
    """Keep every KeyboardInterrupt from being lost within this context.

    A signal handler runs wherever the main thread is. If that is a weakref callback, a `__del__` or
    a callback of the garbage collector, Python reports the exception to `sys.unraisablehook` and
    continues as if nothing had happened; JAX has many weakref callbacks. Here the signal is sent
    again, shortly after: the handler of SIGINT at that time receives it.
    """
    before, is_over = sys.unraisablehook, threading.Event()

    def hook(lost: "sys.UnraisableHookArgs") -> None:
        if not issubclass(lost.exc_type, KeyboardInterrupt):
            before(lost)
        else:
            # Low-level, since `threading.Thread.start` waits, and this can run at any moment.
            _thread.start_new_thread(_send_again, (is_over.is_set,))

    sys.unraisablehook = hook
    try:
        yield
    finally:
        is_over.set()
        sys.unraisablehook = before


def _send_again(is_over: Callable[[], bool]) -> None:
    time.sleep(PAUSE)
    main = threading.main_thread().ident
    if main is not None and not is_over():
        signal.pthread_kill(main, signal.SIGINT)
