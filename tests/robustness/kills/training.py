"""A training in a process of its own, forked from one that has imported everything."""

import os
import sys
from collections.abc import Collection, Sequence
from pathlib import Path

import numpy as np
import yaml

from benchmarks.tiny import tiny_training
from jaxleas.files.npz import read_arrays
from jaxleas.runs.metrics import read_metrics

UPDATES = 24


def write_config(path: Path) -> None:
    """Write the configuration of the training: seconds long, with a dozen checkpoints."""
    path.write_text(yaml.safe_dump(tiny_training(UPDATES)))


class Training:
    """`python train.py ARGUMENTS`, forked: what takes longest is importing, and done once.

    This process must not start JAX's devices, nor threads, before it forks.

    Attributes:
        code: its exit code, negative for the signal that ended it; None while it lives.
    """

    def __init__(self, arguments: Sequence[str], log: Path) -> None:
        self.code: int | None = None
        self._log = log
        self.pid = os.fork()
        if self.pid == 0:
            os._exit(_train(arguments, log))

    @property
    def output(self) -> str:
        """All that it said."""
        return self._log.read_text(errors="replace") if self._log.is_file() else ""

    def is_alive(self) -> bool:
        """Return whether it goes on."""
        if self.code is None:
            pid, status = os.waitpid(self.pid, os.WNOHANG)
            if pid:
                self.code = os.waitstatus_to_exitcode(status)
        return self.code is None

    def end(self, number: int | None = None) -> int:
        """Send a signal, if any, wait for the end and return the exit code."""
        if self.is_alive():
            if number is not None:
                os.kill(self.pid, number)
            self.code = os.waitstatus_to_exitcode(os.waitpid(self.pid, 0)[1])
        assert self.code is not None
        return self.code


def _train(arguments: Sequence[str], log: Path) -> int:
    from jaxleas.cli_guard import run_guarded
    from train import main

    stream = os.open(log, os.O_WRONLY | os.O_CREAT | os.O_TRUNC, 0o644)
    os.dup2(stream, 1)
    os.dup2(stream, 2)
    sys.argv = ["train.py", *arguments]
    code = 1
    try:
        code = run_guarded(lambda: main(arguments))
    finally:
        sys.stdout.flush()
        sys.stderr.flush()
    return code


def content(run: Path, but: Collection[Path] = ()) -> dict[str, object]:
    """Return all that a run has come to, but for wall time: to compare bit by bit.

    Args:
        run: folder.
        but: files to pass over.

    Raises:
        InputError: a file cannot be read whole.
        DamagedError: likewise.
    """
    found: dict[str, object] = {"config": (run / "config.yaml").read_text()}
    for path in [*(run / "checkpoints").glob("*"), run / "policy.npz"]:
        if path.is_file() and not path.name.startswith(".") and path not in but:
            arrays = read_arrays(path)
            found[path.name] = {name: _bits(array) for name, array in arrays.items()}
    metrics = run / "metrics.jsonl"
    found["metrics"] = [
        {name: value for name, value in row.items() if name != "seconds"}
        for row in (read_metrics(metrics) if metrics.is_file() else ())
    ]
    return found


def _bits(array: np.ndarray) -> tuple[str, tuple[int, ...], bytes]:
    return array.dtype.str, array.shape, array.tobytes()
