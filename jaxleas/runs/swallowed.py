"""Ctrl-C that comes at a moment when Python throws its exception away, raised again."""

import _thread
import signal
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

PAUSE = 0.02
"""Between the loss of an interrupt and the next try [s]; what has swallowed it is over by then."""


@contextmanager
def interrupts_kept() -> Iterator[None]:
    """Within this context no KeyboardInterrupt is lost.

    A signal handler runs wherever the main thread is. If that is a weakref callback, a `__del__` or
    a callback of the garbage collector, Python reports the exception to `sys.unraisablehook` and
    goes on as if nothing had happened; JAX is full of weakref callbacks. Here the signal is sent
    once more, shortly after: whatever handles SIGINT by then takes it.
    """
    before, is_over = sys.unraisablehook, threading.Event()

    def hook(lost: "sys.UnraisableHookArgs") -> None:
        if not issubclass(lost.exc_type, KeyboardInterrupt):
            before(lost)
        else:
            # Bare, since `threading.Thread.start` waits, and this can be any moment at all.
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
