"""A folder held by one writer at a time, also among machines that share it."""

import fcntl
import json
import logging
import os
import socket
import threading
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryFile
from types import TracebackType
from typing import Any, Self

from jaxleas.types.errors import InputError

PULSE = 10.0
"""The holder touches its lock this often [s]."""
SILENCE = 60.0
"""A holder on another machine that has not touched its lock for so long is dead [s]."""
_LOG = logging.getLogger("jaxleas")


class FolderLock:
    """Holds a folder until `close`, or until this process ends by whatever cause.

    The kernel keeps the lock (`flock`), so that the death of its holder frees it: there are no
    stale locks on one machine. Network file systems mostly pass it on between machines; where one
    does not, the lock's pulse does its work: the holder touches the file every `PULSE` seconds, and
    another machine takes it over only after `SILENCE` seconds without.

    Args:
        folder: to hold; must exist.
        what: to call it in a sentence, as "the run folder".
        remedy: what else one could do, as "name another --run-dir".

    Raises:
        InputError: somebody else holds it, or it cannot be locked.
    """

    def __init__(self, folder: str | Path, what: str, remedy: str) -> None:
        self._name = f"{what} {folder}"
        self._remedy = remedy
        self._over = threading.Event()
        self._descriptor: int | None = _open(Path(folder) / "lock", self._name)
        try:
            self._take(Path(folder))
        except BaseException:
            os.close(self._descriptor)
            raise
        threading.Thread(target=self._beat, name="folder lock", daemon=True).start()

    def close(self) -> None:
        """Let others write."""
        if self._descriptor is not None:
            self._over.set()
            descriptor, self._descriptor = self._descriptor, None
            os.ftruncate(descriptor, 0)  # left on purpose, not by dying
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
            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError as error:
            raise InputError(
                f"{self._name} is in use by {_Holder.of(descriptor)}; wait for it, stop it, or"
                f" {self._remedy}"
            ) from error
        except OSError as error:
            raise InputError(f"cannot lock {self._name}: {error.strerror}") from error
        before = _Holder.of(descriptor)
        if before.host not in ("", socket.gethostname()):
            self._require_silence(before, _age(descriptor, folder))
        try:
            os.ftruncate(descriptor, 0)
            os.pwrite(descriptor, _Holder(os.getpid(), socket.gethostname()).text().encode(), 0)
        except OSError as error:
            raise InputError(f"cannot lock {self._name}: {error.strerror}") from error
        if before.process:
            _LOG.warning("%s was left behind by %s, which did not close it", self._name, before)

    def _require_silence(self, before: "_Holder", age: float) -> None:
        if age < SILENCE:
            raise InputError(
                f"{self._name} is in use by {before}, which showed a sign of life {age:.0f} s ago;"
                f" if it is dead, try again in {SILENCE - age:.0f} s, or {self._remedy}"
            )

    def _beat(self) -> None:
        while not self._over.wait(PULSE):
            try:
                if self._descriptor is not None:
                    os.utime(self._descriptor)
            except OSError:  # closed meanwhile, or the server is away for a moment
                continue


@dataclass(frozen=True)
class _Holder:
    """Who holds a lock, as written into it; 0 and "" where nobody does."""

    process: int
    host: str

    @classmethod
    def of(cls, descriptor: int) -> "_Holder":
        try:
            said: Any = json.loads(os.pread(descriptor, 1024, 0).decode(errors="replace"))
        except ValueError:  # nobody, or cut short by a full disk
            return cls(0, "")
        if isinstance(said, int):  # as versions before 0.2 wrote it
            return cls(said, "")
        known = isinstance(said, dict) and isinstance(said.get("process"), int)
        return cls(said["process"], str(said.get("host", ""))) if known else cls(0, "")

    def text(self) -> str:
        return json.dumps({"process": self.process, "host": self.host}) + "\n"

    def __str__(self) -> str:
        where = f" on {self.host}" if self.host not in ("", socket.gethostname()) else ""
        return f"process {self.process or 'unknown'}{where}"


def _open(path: Path, name: str) -> int:
    try:
        return os.open(path, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o644)
    except OSError as error:
        raise InputError(f"cannot lock {name}: {error.strerror}") from error


def _age(descriptor: int, folder: Path) -> float:
    """Return for how long a lock was not touched, by the clock of the file system's host [s]."""
    try:
        with TemporaryFile(dir=folder) as now:
            return os.fstat(now.fileno()).st_mtime - os.fstat(descriptor).st_mtime
    except OSError:
        return 0.0
