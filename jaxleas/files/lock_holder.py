"""Who holds a folder, as the lock in it tells."""

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
"""A holder on another machine that has not touched its lock for so long is dead [s]."""


@dataclass(frozen=True)
class Holder:
    """The process that holds a folder, as written into its lock; 0 and "" where there is none."""

    process: int
    host: str

    @classmethod
    def of(cls, descriptor: int) -> "Holder":
        """Read the holder from an open lock file."""
        try:
            said: Any = json.loads(os.pread(descriptor, 1024, 0).decode(errors="replace"))
        except ValueError:  # no holder, or cut short by a full disk
            return cls(0, "")
        if isinstance(said, int):  # as versions before 0.2 wrote it
            return cls(said, "")
        known = isinstance(said, dict) and isinstance(said.get("process"), int)
        return cls(said["process"], str(said.get("host", ""))) if known else cls(0, "")

    @classmethod
    def here(cls) -> "Holder":
        """Return this process."""
        return cls(os.getpid(), socket.gethostname())

    @property
    def is_elsewhere(self) -> bool:
        """Whether the holder is on another machine, whose death frees no lock here."""
        return self.host not in ("", socket.gethostname())

    def text(self) -> str:
        """Return what is written into the lock."""
        return json.dumps({"process": self.process, "host": self.host}) + "\n"

    def __str__(self) -> str:
        where = f" on {self.host}" if self.is_elsewhere else ""
        return f"process {self.process or 'unknown'}{where}"


def is_held(folder: str | Path) -> bool:
    """Whether a process on any machine holds a folder; asks with the lock's own two questions.

    Args:
        folder: folder that `FolderLock` may hold.
    """
    try:
        descriptor = os.open(Path(folder) / LOCK, os.O_RDONLY | os.O_CLOEXEC)
    except OSError:
        return False
    try:
        # Shared, so that two that ask at once do not take each other for the holder.
        fcntl.flock(descriptor, fcntl.LOCK_SH | fcntl.LOCK_NB)
        return _shows_signs_of_life(descriptor, Path(folder))
    except BlockingIOError:
        return True
    except OSError:  # a file system without locks: the pulse alone can tell
        return _shows_signs_of_life(descriptor, Path(folder))
    finally:
        os.close(descriptor)


def silence_of(descriptor: int, folder: Path) -> float:
    """Return for how long a lock has not been touched [s].

    The clock is that of the file system's host, or this machine's where nothing can be written.
    """
    touched = os.fstat(descriptor).st_mtime
    try:
        with TemporaryFile(dir=folder) as now:
            return os.fstat(now.fileno()).st_mtime - touched
    except OSError:
        return time.time() - touched


def _shows_signs_of_life(descriptor: int, folder: Path) -> bool:
    """Whether a holder on another machine, whose lock does not get here, has touched it lately."""
    return Holder.of(descriptor).is_elsewhere and silence_of(descriptor, folder) < SILENCE
