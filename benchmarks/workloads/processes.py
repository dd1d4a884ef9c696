"""Programs in fresh processes: their time from start, their memory."""

import os
import subprocess
import sys
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from benchmarks.context import ROOT
from jaxleas.types import JaxleasError

# A process inherits the peak of the one that forked it, so a small process is in between.
_WEIGH = """
import resource, subprocess, sys
code = subprocess.call([sys.executable, *sys.argv[2:]])
with open(sys.argv[1], "w") as stream:
    stream.write(str(resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss))
sys.exit(code)
"""


class ChildError(JaxleasError):
    """A measured program failed."""


@dataclass(frozen=True)
class Finished:
    """A program that ended without an error.

    Attributes:
        began: time of its start, by `time.time` [s].
        peak: peak of its memory [MiB].
        output: text that it wrote to standard output.
    """

    began: float
    peak: float
    output: str


def start(words: Sequence[str], cache: Path, log: Path) -> subprocess.Popen:
    """Start a Python program with its own compile cache; its output goes to `log`."""
    with log.open("w", encoding="utf-8") as stream:
        return subprocess.Popen(
            [sys.executable, *words],
            cwd=ROOT,
            env=os.environ
            | {
                "JAX_COMPILATION_CACHE_DIR": str(cache),
                # The measuring process already holds most of a GPU's memory.
                "XLA_PYTHON_CLIENT_PREALLOCATE": "false",
            },
            stdout=stream,
            stderr=subprocess.STDOUT,
        )


def run(words: Sequence[str], cache: Path, log: Path) -> Finished:
    """Run a Python program to its end.

    Raises:
        ChildError: the program failed.
    """
    peak = log.with_name(f"{log.name}.peak")
    began = time.time()
    process = start(["-I", "-S", "-c", _WEIGH, str(peak), *words], cache, log)
    process.wait()
    output = log.read_text(encoding="utf-8", errors="replace")
    require_success(process.returncode, words, output)
    # Linux counts in kilobytes, macOS in bytes.
    unit = 1024.0**2 if sys.platform == "darwin" else 1024.0
    return Finished(began, int(peak.read_text(encoding="utf-8")) / unit, output)


def require_success(code: int, words: Sequence[str], output: str) -> None:
    """Raise ChildError with the last line of a program's output unless it succeeded."""
    if code:
        last = (output.strip().splitlines() or ["it said nothing"])[-1]
        raise ChildError(f"`python {' '.join(words)}` failed: {last}")
