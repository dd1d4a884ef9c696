"""Sweeps whose workers pretend, conducted here or in processes that may be killed."""

import multiprocessing
import os
import sys
from multiprocessing.context import ForkServerProcess
from pathlib import Path
from unittest.mock import patch

from jaxleas.cli_guard import run_guarded
from jaxleas.sweeps import conductor
from jaxleas.sweeps.border import open_sweep
from jaxleas.sweeps.conductor import Conductor
from jaxleas.sweeps.folder import open_folder
from jaxleas.sweeps.processes import Processes
from jaxleas.sweeps.results import TrialResult
from jaxleas.sweeps.study import Study

PRETENDER = (sys.executable, "-S", "-E", str(Path(__file__).with_name("pretender.py")))
# Imports everything once; each process is forked from it. It starts no thread and no device.
_NURSERY = multiprocessing.get_context("forkserver")
_NURSERY.set_forkserver_preload([__name__, "optuna"])


def conduct(path: Path, out: Path, command=PRETENDER, storage=None) -> list[TrialResult]:
    """Conduct a sweep; the workers are quick, and so are the looks at them."""
    sweep = open_sweep(path)
    folder = open_folder(out, sweep)
    try:
        study = Study(sweep, folder, storage)
        runner = Processes(sweep.config.parallel, command)
        with patch.object(conductor, "PAUSE", 0.02):
            return Conductor(sweep, folder, study, runner).run()
    finally:
        folder.close()


def start(path: Path, out: Path, log: Path, storage: str | None = None) -> ForkServerProcess:
    """Conduct a sweep in a process of its own, which says what it has to say into a file."""
    process = _NURSERY.Process(target=_conduct, args=(path, out, log, storage))
    process.start()
    return process


def _conduct(path: Path, out: Path, log: Path, storage: str | None) -> None:
    stream = os.open(log, os.O_WRONLY | os.O_CREAT | os.O_TRUNC)
    os.dup2(stream, 1)
    os.dup2(stream, 2)
    sys.exit(run_guarded(lambda: conduct(path, out, PRETENDER, storage) and None))
