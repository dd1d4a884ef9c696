"""One process that reads what strangers send, watched from outside."""

import contextlib
import json
import os
import random
import resource
import signal
import sys
import tempfile
import time
import traceback
import warnings
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from jaxleas.types import JaxleasError
from tests.robustness.hostile_files.corpus import make_corpus
from tests.robustness.hostile_files.kinds import Kind

MOST_SECONDS = 20.0  # of processor time: a crowded machine is no reader's fault
MOST_MEMORY = 6 * 2**30  # of address space beyond what the process has at the start


class TooSlowError(Exception):
    """A reader that did not end in time."""


def read_all(first: int, last: int, seed: int, tell: Any, only: str | None = None) -> None:
    """Read inputs number `first` to `last`, telling of each before and after.

    Args:
        first: number of the first input.
        last: number after the last.
        seed: of all mutations; an input depends on it and on its own number alone.
        tell: writes one JSON object a line.
        only: the kind of all of them; by default each kind in turn.
    """
    warnings.simplefilter("ignore")
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(temporary)
        kinds = make_corpus(folder / "valid")
        chosen = [kind for kind in kinds if only in (None, kind.name)]
        for kind in kinds:
            kind.read(_lay_out(folder / "reading", kind, kind.content))  # what is valid is read
        _limit_memory()
        os.chdir(folder)
        for number in range(first, last):
            kind = chosen[number % len(chosen)]
            content = input_of(kind, kinds, seed, number)
            path = _lay_out(folder / "reading", kind, content)
            tell({"begins": number, "kind": kind.name})
            tell(
                {"number": number, "kind": kind.name, "bytes": len(content), **_outcome(kind, path)}
            )


def input_of(kind: Kind, kinds: list[Kind], seed: int, number: int) -> bytes:
    """Return the input of a number."""
    return kind.mutated(random.Random(f"{seed} {number} {kind.name}"), kinds)


def _outcome(kind: Kind, path: Path) -> dict[str, Any]:
    before = _peak()
    begun = time.process_time()
    failure, outcome = None, "accepted"
    try:
        with _time_limit():
            kind.read(path)
    except JaxleasError as error:
        outcome = "refused"
        if "\n" in str(error).strip():
            failure = f"a sentence of several lines: {error}"
        str(error).encode()
    except BaseException as error:
        outcome = "failed"
        frames = traceback.extract_tb(error.__traceback__)
        own = [f"{Path(f.filename).name}:{f.lineno}" for f in frames if "jaxleas" in f.filename]
        failure = f"{type(error).__name__}: {str(error)[:200]} at {' '.join(own[-3:])}"
    seconds = time.process_time() - begun
    return {
        "outcome": outcome,
        "failure": failure,
        "seconds": round(seconds, 4),
        "megabytes": round((_peak(reset=False) - before) / 2**20, 1),
    }


def _lay_out(folder: Path, kind: Kind, content: bytes) -> Path:
    """Write the file, and what it needs, into a folder of its kind."""
    path = folder / kind.name.replace(" ", "_") / kind.file
    path.parent.mkdir(parents=True, exist_ok=True)
    for name, companion in kind.companions.items():
        if not (path.parent / name).exists():
            (path.parent / name).write_bytes(companion)
    path.write_bytes(content)
    return path


@contextlib.contextmanager
def _time_limit() -> Iterator[None]:
    def give_up(*_: object) -> None:
        raise TooSlowError(f"not done after {MOST_SECONDS:g} s")

    signal.signal(signal.SIGPROF, give_up)
    signal.setitimer(signal.ITIMER_PROF, MOST_SECONDS)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0.0)


def _limit_memory() -> None:
    used = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
    resource.setrlimit(resource.RLIMIT_AS, (used + MOST_MEMORY, resource.RLIM_INFINITY))


def _peak(reset: bool = True) -> int:
    """Return the most memory resident since the last reset; begin to count anew."""
    if reset:
        Path("/proc/self/clear_refs").write_text("5")
    lines = Path("/proc/self/status").read_text().splitlines()
    return 1024 * next(int(line.split()[1]) for line in lines if line.startswith("VmHWM"))


if __name__ == "__main__":
    first, last, seed = map(int, sys.argv[1:4])
    stream = os.fdopen(int(sys.argv[4]), "w", buffering=1)
    read_all(
        first,
        last,
        seed,
        lambda line: print(json.dumps(line), file=stream),
        sys.argv[5] if len(sys.argv) > 5 else None,
    )
