"""The holder of a folder, as written in its lock."""

import fcntl
import json
import os
import socket
import time
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryFile
from typing import Any

LOCK = "lock"
"""Name of the lock file in a folder."""
SILENCE = 60.0
"""Time after which a holder on another machine that has not touched its lock counts as dead [s]."""


@dataclass(frozen=True)
class Holder:
    """The process that holds a folder, as written into its lock; 0 and "" if there is none."""

    process: int
    host: str

    @classmethod
    def of(cls, descriptor: int) -> "Holder":
        """Read the holder from an open lock file."""
        try:
            said: Any = json.loads(os.pread(descriptor, 1024, 0).decode(errors="replace"))
        except ValueError:  # no holder, or cut short by a full disk
            return cls(0, "")
        if isinstance(said, int):  # format of versions before 0.2
            return cls(said, "")
        known = isinstance(said, dict) and isinstance(said.get("process"), int)
        return cls(said["process"], str(said.get("host", ""))) if known else cls(0, "")

    @classmethod
    def here(cls) -> "Holder":
        """Return this process."""
        return cls(os.getpid(), socket.gethostname())

    @property
    def is_elsewhere(self) -> bool:
        """Return whether the holder is on another machine, whose death frees no lock here."""
        return self.host not in ("", socket.gethostname())

    def text(self) -> str:
        """Return the text to write into the lock."""
        return json.dumps({"process": self.process, "host": self.host}) + "\n"

    def __str__(self) -> str:
        where = f" on {self.host}" if self.is_elsewhere else ""
        return f"process {self.process or 'unknown'}{where}"


def is_held(folder: str | Path) -> bool:
    """Return whether a process on any machine holds a folder, by the same two checks as the lock.

    Args:
        folder: folder that `FolderLock` may hold.
    """
    try:
        descriptor = os.open(Path(folder) / LOCK, os.O_RDONLY | os.O_CLOEXEC)
    except OSError:
        return False
    try:
        # Shared, so that two processes that ask at once do not mistake each other for the holder.
        fcntl.flock(descriptor, fcntl.LOCK_SH | fcntl.LOCK_NB)
        return _shows_signs_of_life(descriptor, Path(folder))
    except BlockingIOError:
        return True
    except OSError:  # a file system without locks: only the pulse counts
        return _shows_signs_of_life(descriptor, Path(folder))
    finally:
        os.close(descriptor)


def silence_of(descriptor: int, folder: Path) -> float:
    """Return the time since a lock was last touched [s].

    The clock is that of the file system's host, or this machine's if nothing can be written.
    """
    touched = os.fstat(descriptor).st_mtime
    try:
        with TemporaryFile(dir=folder) as now:
            return os.fstat(now.fileno()).st_mtime - touched
    except OSError:
        return time.time() - touched


def _shows_signs_of_life(descriptor: int, folder: Path) -> bool:
    """Return whether a holder on another machine, whose lock is not visible here, is alive."""
    return Holder.of(descriptor).is_elsewhere and silence_of(descriptor, folder) < SILENCE
