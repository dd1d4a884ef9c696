"""A folder held by one writer at a time, also among machines that share it."""

import fcntl
import logging
import os
import threading
import time
from pathlib import Path
from types import TracebackType
from typing import Self

from jaxleas.files.lock_holder import LOCK, SILENCE, Holder, silence_of
from jaxleas.types import InputError

PULSE = 10.0
"""Interval at which the holder touches its lock [s]."""
PATIENCE = 0.2
"""Longest time for which a process that only asks for the holder may hold the lock [s]."""
_LOG = logging.getLogger("jaxleas")


class InUseError(InputError):
    """A folder is held by another process, which may release it later."""


class FolderLock:
    """Lock on a folder, held until `close`, or until this process ends for any reason.

    The kernel keeps the lock (`flock`), so that the death of its holder frees it: there are no
    stale locks on one machine. Most network file systems pass the lock on between machines; where
    one does not, a pulse replaces it: the holder touches the file every `PULSE` seconds, and
    another machine takes the lock over only after `SILENCE` seconds without a touch.

    Args:
        folder: path of the folder to hold, which must exist.
        what: name of the folder in messages, such as "the run folder".
        remedy: alternative to suggest in messages, such as "name another --run-dir".

    Raises:
        InUseError: another process holds it.
        InputError: the folder cannot be locked.
    """

    def __init__(self, folder: str | Path, what: str, remedy: str) -> None:
        self._name = f"{what} {folder}"
        self._remedy = remedy
        self._over = threading.Event()
        self._descriptor: int | None = _open(Path(folder) / LOCK, self._name)
        try:
            self._take(Path(folder))
        except BaseException:
            os.close(self._descriptor)
            raise
        threading.Thread(target=self._beat, name="folder lock", daemon=True).start()

    def close(self) -> None:
        """Release the lock, so that other processes can write."""
        if self._descriptor is not None:
            self._over.set()
            descriptor, self._descriptor = self._descriptor, None
            os.ftruncate(descriptor, 0)  # released on purpose, not by dying
            os.close(descriptor)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()

    def _take(self, folder: Path) -> None:
        descriptor = self._descriptor
        assert descriptor is not None
        try:
            _lock(descriptor)
        except BlockingIOError as error:
            raise InUseError(
                f"{self._name} is in use by {Holder.of(descriptor)}; wait for it, stop it, or"
                f" {self._remedy}"
            ) from error
        except OSError as error:
            raise InputError(f"cannot lock {self._name}: {error.strerror}") from error
        before = Holder.of(descriptor)
        if before.is_elsewhere:
            self._require_silence(before, silence_of(descriptor, folder))
        try:
            os.ftruncate(descriptor, 0)
            os.pwrite(descriptor, Holder.here().text().encode(), 0)
        except OSError as error:
            raise InputError(f"cannot lock {self._name}: {error.strerror}") from error
        if before.process:
            _LOG.warning("%s was left behind by %s, which did not close it", self._name, before)

    def _require_silence(self, before: Holder, age: float) -> None:
        if age < SILENCE:
            raise InUseError(
                f"{self._name} is in use by {before}, which showed a sign of life {age:.0f} s ago;"
                f" if it is dead, try again in {SILENCE - age:.0f} s, or {self._remedy}"
            )

    def _beat(self) -> None:
        while not self._over.wait(PULSE):
            try:
                if self._descriptor is not None:
                    os.utime(self._descriptor)
            except OSError:  # closed meanwhile, or the server is briefly unavailable
                continue


def _open(path: Path, name: str) -> int:
    try:
        return os.open(path, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o644)
    except OSError as error:
        raise InputError(f"cannot lock {name}: {error.strerror}") from error


def _lock(descriptor: int) -> None:
    """Take a lock; wait briefly if it is only held to ask for the holder (`is_held`)."""
    until = time.monotonic() + PATIENCE
    while True:
        try:
            return fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            if time.monotonic() > until:
                raise
        time.sleep(0.01)
