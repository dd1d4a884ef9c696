"""Conducts a sweep whose workers pretend: `python -m tests.sweeps.pretended SWEEP.yaml OUT`."""

import sys
from pathlib import Path

from jaxleas.cli_guard import run_guarded
from jaxleas.sweeps.border import open_sweep
from jaxleas.sweeps.conductor import Conductor
from jaxleas.sweeps.folder import open_folder
from jaxleas.sweeps.results import TrialResult
from jaxleas.sweeps.runners import Processes
from jaxleas.sweeps.study import Study

PRETENDER = (sys.executable, str(Path(__file__).with_name("pretender.py")))


def conduct(path: Path, out: Path, command=PRETENDER, storage=None) -> list[TrialResult]:
    sweep = open_sweep(path)
    folder = open_folder(out, sweep)
    try:
        study = Study(sweep, folder, storage)
        runner = Processes(sweep.config.parallel, command)
        return Conductor(sweep, folder, study, runner).run()
    finally:
        folder.close()


if __name__ == "__main__":
    sys.exit(run_guarded(lambda: conduct(Path(sys.argv[1]), Path(sys.argv[2]), PRETENDER) and None))
