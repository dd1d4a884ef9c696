"""Asking the process that reads with libraries."""

import atexit
import json
import logging
import os
import subprocess
import sys
import tempfile
import threading
from pathlib import Path
from typing import Any

import numpy as np

from jaxleas.files import read_npz, require_file
from jaxleas.terrain.foreign.answers import LACKS, REFUSED
from jaxleas.terrain.foreign.limits import CPU_SECONDS, MAX_ANSWER, MEMORY
from jaxleas.types import InputError

_LOG = logging.getLogger("jaxleas")
MAX_BYTES = 2**30  # of a file that is read
_ONE_THREAD = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1")


class _Server:
    """The process, started when first asked; a copy of this process starts its own."""

    def __init__(self) -> None:
        self._process: subprocess.Popen[str] | None = None
        self._owner = 0
        self._lock = threading.Lock()

    def code_of(self, request: dict[str, Any]) -> int:
        """Return how the process that answers a request ended."""
        with self._lock:
            process = self._running()
            assert process.stdin is not None
            assert process.stdout is not None
            try:
                print(json.dumps(request), file=process.stdin, flush=True)
                line = process.stdout.readline()
            except BrokenPipeError:
                line = ""
            if not line:
                self.close()
                return 1
            return int(json.loads(line)["code"])

    def _running(self) -> "subprocess.Popen[str]":
        alive = self._process is not None and self._process.poll() is None
        if not alive or self._owner != os.getpid():
            self._owner = os.getpid()
            self._process = subprocess.Popen(
                [sys.executable, "-m", "jaxleas.terrain.foreign.server"],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=subprocess.DEVNULL,
                env=os.environ | _ONE_THREAD,
                text=True,
            )
        assert self._process is not None
        return self._process

    def close(self) -> None:
        """End the process."""
        if self._process is not None and self._owner == os.getpid():
            self._process.terminate()
            self._process.communicate()
            self._process = None


_SERVER = _Server()
atexit.register(_SERVER.close)


def ask(reader: str, path: Path, **options: Any) -> dict[str, np.ndarray]:
    """Return the arrays of a file that a library reads in another process; notes are said.

    Args:
        reader: name of a module of this folder.
        path: path of the file, or of a folder for a bag of ROS 2.
        options: plain values for the reader.

    Raises:
        InputError: the file is missing, cannot be used, breaks a bound, or the library is not
            installed.
    """
    if not path.is_dir():
        require_file(path, MAX_BYTES)
    with tempfile.TemporaryDirectory() as folder:
        answer = Path(folder) / "answer.npz"
        request = {
            "reader": reader,
            "path": str(path.absolute()),
            "options": options,
            "answer": str(answer),
        }
        code = _SERVER.code_of(request)
        if code == REFUSED:
            raise InputError(f"{path} {answer.read_text()}")
        if code == LACKS:
            raise InputError(
                f"{path} is read by the library {answer.read_text()}, which is not installed:"
                " pip install 'jaxleas[maps]'"
            )
        if code != 0:
            raise InputError(
                f"{path} could not be read within {MEMORY // 2**30} GiB and {CPU_SECONDS} s, or"
                f" broke its reader (exit {code})"
            )
        arrays = read_npz(answer, ("notes",), 4 * MAX_ANSWER)
    for note in arrays.pop("notes"):
        _LOG.warning("%s %s", path, note)
    return arrays
