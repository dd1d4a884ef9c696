"""A sweep on a local Ray cluster whose workers are killed: nothing lost, nothing twice."""

import json
import os
import signal
from pathlib import Path

import pytest

from jaxleas.sweeps.border import open_sweep
from jaxleas.sweeps.conductor import Conductor
from jaxleas.sweeps.folder import open_folder
from jaxleas.sweeps.ray_jobs import RayJobs
from jaxleas.sweeps.study import Study
from tests.sweeps import pretender
from tests.sweeps.files import write_sweep

pytest.importorskip("optuna", reason="the extra sweep is not installed")


def pretend_and_die_once(job: str) -> str:
    """Do a job; the worker of every second trial is killed when it first begins."""
    for each in json.loads(Path(job).read_text())["trainings"]:
        run = Path(each["run"])
        if int(run.parent.name) % 2 and not run.is_dir():
            run.mkdir(parents=True)
            pretender.note(run, "begun")
            os.kill(os.getpid(), signal.SIGKILL)
        pretender.pretend(run, json.loads(each["config"]))
    return ""


@pytest.mark.slow
def test_a_killed_worker_of_ray_costs_nothing(tmp_path):
    pytest.importorskip("ray", reason="the extra ray is not installed")
    sweep = open_sweep(write_sweep(tmp_path, trials=4, vectorised=False, parallel=2))
    folder = open_folder(tmp_path / "out", sweep)
    runner = RayJobs(2, pretend_and_die_once)
    results = Conductor(sweep, folder, Study(sweep, folder, None), runner).run()
    folder.close()
    assert [(each.number, each.state) for each in results] == [(n, "done") for n in range(4)]
    for number in range(4):
        diary = (folder.run(number, 0) / "diary").read_text().split()
        assert diary == ["begun"] * (1 + number % 2) + ["ended"]
