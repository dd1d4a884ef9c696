"""A sweep loses nothing and counts nothing twice, whoever is killed. The workers only pretend."""

import csv
import json
import os
import random
import signal
import subprocess
import sys
import threading
import time
from dataclasses import asdict
from pathlib import Path

import pytest

from jaxleas.files import InUseError, write_json
from jaxleas.sweeps import study as study_room
from jaxleas.sweeps.border import open_sweep
from jaxleas.sweeps.folder import open_folder
from jaxleas.sweeps.job import LIFELINE, patiently
from jaxleas.sweeps.job_files import Outcome, outcome_file, write_job
from jaxleas.sweeps.results import TrialResult
from jaxleas.sweeps.run_folders import hold_run_folder
from jaxleas.sweeps.study import Study, read_results
from jaxleas.types import InputError
from tests.sweeps.files import write_sweep
from tests.sweeps.pretended import conduct, start
from tests.training.runs import ROOT, tiny

pytest.importorskip("optuna", reason="the extra sweep is not installed")
SPACE = {
    "ppo.learning_rate": {"low": 1e-4, "high": 1e-2, "log": True},
    "ppo.mirror": {"choices": [True, False]},
    "ppo.epochs": {"low": 1, "high": 3, "only_when": {"ppo.mirror": True}},
}


def told(out) -> int:
    path = out / "results.json"
    return len(json.loads(path.read_text())["trials"]) if path.is_file() else 0


@pytest.mark.slow
@pytest.mark.parametrize("vectorised", [False, "auto"])
def test_killed_three_times_it_ends_with_every_trial_once(tmp_path, vectorised):
    space = SPACE if not vectorised else {"ppo.learning_rate": SPACE["ppo.learning_rate"]}
    path = write_sweep(tmp_path, space=space, trials=20, parallel=2, vectorised=vectorised)
    out, log, stream = tmp_path / "out", tmp_path / "log", random.Random(7)
    for kill in range(3):
        process = start(path, out, log)
        while told(out) < 4 * (kill + 1) and process.is_alive():
            time.sleep(0.01)
        time.sleep(stream.random() * 0.3)
        assert process.is_alive(), log.read_text()
        process.kill()
        process.join()
    process = start(path, out, log)
    process.join(120)
    assert process.exitcode == 0, log.read_text()
    results = read_results(out)
    assert [each.number for each in results] == list(range(20))
    assert all(each.state == "done" and len(each.seeds) == 1 for each in results)
    for each in results:
        assert each.values["held_out"] == pytest.approx(
            min(1.0, 100 * each.params["ppo.learning_rate"])
        )
    runs = list(out.glob("trials/*/seed_0"))
    assert len(runs) == 20
    for run in runs:
        steps = [json.loads(row)["step"] for row in (run / "metrics.jsonl").open()]
        assert steps == [640, 1280, 1920, 2560]
    rows = list(csv.DictReader((out / "results.csv").open()))
    assert [int(row["trial"]) for row in rows] == list(range(20))


def test_a_killed_worker_is_replaced_and_its_training_goes_on(tmp_path):
    """The pretender kills itself once in every training, after its second examination."""
    script = tmp_path / "mortal.py"
    script.write_text(
        "import json, os, pathlib, sys\n"
        "sys.path.insert(0, sys.argv[1])\n"
        "from tests.sweeps import pretender\n"
        "def sleep(seconds):\n"
        "    begun = (run / 'diary').read_text().split().count('begun')\n"
        "    rows = run / 'metrics.jsonl'\n"
        "    if begun == 1 and rows.is_file() and len(rows.read_text().splitlines()) == 2:\n"
        "        os.kill(os.getpid(), 9)\n"
        "pretender.time.sleep = sleep\n"
        "for each in json.loads(pathlib.Path(sys.argv[2]).read_text())['trainings']:\n"
        "    run = pathlib.Path(each['run'])\n"
        "    pretender.pretend(run, json.loads(each['config']))\n"
    )
    path = write_sweep(tmp_path, space=SPACE, trials=2)
    out = tmp_path / "out"
    results = conduct(path, out, (sys.executable, str(script), str(ROOT)))
    assert [each.state for each in results] == ["done", "done"]
    for run in out.glob("trials/*/seed_0"):
        assert (run / "diary").read_text().split() == ["begun", "begun", "ended"]
        steps = [json.loads(row)["step"] for row in (run / "metrics.jsonl").open()]
        assert steps == [640, 1280, 1920, 2560]


def test_a_worker_that_always_dies_fails_its_trial_alone(tmp_path):
    path = write_sweep(tmp_path, space=SPACE, trials=2)
    dies = (sys.executable, "-c", "raise SystemExit(9)")
    results = conduct(path, tmp_path / "out", dies)
    assert [each.state for each in results] == ["failed", "failed"]
    assert "3 workers ended over it" in results[0].reason
    assert "exit code 9" in results[0].reason


def test_the_pruner_ends_bad_trials_at_an_examination(tmp_path, monkeypatch):
    monkeypatch.setenv("PRETENDED_PAUSE", "0.1")
    path = write_sweep(
        tmp_path, trials=5, pruner="median", startup_trials=2, seeds=[0, 1], sampler="random"
    )
    results = conduct(path, tmp_path / "out")
    states = [each.state for each in results]
    assert states[:2] == ["done", "done"]
    assert "pruned" in states
    done = [each.values["held_out"] for each in results if each.state == "done"]
    for each in results:
        if each.state == "pruned":
            assert 100 * each.params["ppo.learning_rate"] < max(done)
            assert not (tmp_path / f"out/trials/{each.number:04d}/seed_1").exists()


@pytest.mark.slow
def test_two_machines_share_a_study_and_do_each_trial_once(tmp_path):
    path = write_sweep(tmp_path, space=SPACE, trials=4)
    storage = f"sqlite:///{tmp_path}/study.db"
    sweep = open_sweep(path)
    folder = open_folder(tmp_path / "first", sweep)
    Study(sweep, folder, storage)
    folder.close()
    logs = [tmp_path / f"log_{n}" for n in range(2)]
    others = [start(path, tmp_path / f"m{n}", logs[n], storage) for n in range(2)]
    for each, log in zip(others, logs, strict=True):
        each.join(60)
        assert each.exitcode == 0, log.read_text()
    runs = sorted(run.parent.name for run in tmp_path.glob("*/trials/*/seed_0"))
    assert runs == [f"{number:04d}" for number in range(4)]


def test_a_trial_that_another_machine_is_drawing_is_not_taken_over(tmp_path, monkeypatch):
    sweep = open_sweep(write_sweep(tmp_path, space=SPACE, trials=4))
    storage = f"sqlite:///{tmp_path}/study.db"
    folders = [open_folder(tmp_path / name, sweep) for name in ("first", "second")]
    first, second = (Study(sweep, folder, storage) for folder in folders)
    drawn = first.ask()
    soon = threading.Timer(0.3, first.draw, [drawn])
    soon.start()
    assert second.open_trials() == []
    soon.join()
    monkeypatch.setattr(study_room, "DRAWING", 0.2)
    killed = first.ask()  # and its values are never drawn
    assert [each.number for each in second.open_trials()] == [killed.number]


def test_ctrl_c_saves_and_says_how_to_go_on(tmp_path):
    path = write_sweep(tmp_path, space=SPACE, trials=30)
    out, log = tmp_path / "out", tmp_path / "log"
    process = start(path, out, log)
    while told(out) < 1 and process.is_alive():
        time.sleep(0.01)
    os.kill(process.pid, signal.SIGINT)
    process.join(60)
    words = log.read_text()
    assert process.exitcode == 130
    assert "the same command resumes" in words
    assert words.count("\n") == 1
    assert told(out) >= 1


def test_a_folder_is_one_sweeps_and_one_conductors(tmp_path):
    sweep = open_sweep(write_sweep(tmp_path))
    other = open_sweep(write_sweep(tmp_path, "other.yaml", seeds=[5]))
    more = open_sweep(write_sweep(tmp_path, "sweep.yaml", trials=9))
    held = open_folder(tmp_path / "out", sweep)
    with pytest.raises(InputError, match="is in use by"):
        open_folder(tmp_path / "out", sweep)
    held.close()
    with pytest.raises(InputError, match="is a sweep with another file"):
        open_folder(tmp_path / "out", other)
    open_folder(tmp_path / "out", more).close()  # more trials of the same are welcome
    with pytest.raises(InputError, match="exists and is no sweep"):
        open_folder(tmp_path, sweep)


def test_a_trial_cut_short_while_it_was_drawn_is_drawn_to_the_end(tmp_path):
    sweep = open_sweep(write_sweep(tmp_path, space=SPACE))
    folder = open_folder(tmp_path / "out", sweep)
    trial = Study(sweep, folder, None).ask()
    rate = trial.suggest_float("ppo.learning_rate", 1e-4, 1e-2, log=True)  # and here it is killed
    with (folder.journal).open("a") as journal:
        journal.write('{"op_code": 5, "worker')  # in the middle of a line
    again = Study(sweep, folder, None)
    (same,) = again.open_trials()
    values = again.draw(same)
    assert same.number == trial.number
    assert values["ppo.learning_rate"] == rate
    assert "ppo.mirror" in values
    assert again.ask().number == trial.number + 1
    folder.close()


@pytest.mark.parametrize("pruner", ["median", "hyperband"])
def test_pruners_end_the_worse_half_and_never_the_best(tmp_path, pruner):
    path = write_sweep(tmp_path, trials=16, pruner=pruner, startup_trials=3, sampler="random")
    sweep = open_sweep(path)
    folder = open_folder(tmp_path / "out", sweep)
    study = Study(sweep, folder, None)
    pruned = []
    for number in range(16):
        trial, good = study.ask(), number % 2 == 0
        values = study.draw(trial)
        ends = (study.report(trial, n, n / 4 if good else 0.01) for n in range(1, 5))
        state = "pruned" if any(ends) else "done"
        pruned += [good] if state == "pruned" else []
        success = {"held_out": 1.0 if good else 0.01} if state == "done" else {}
        study.tell(trial, TrialResult(number, state, values, success, {}))
    folder.close()
    assert study.ask() is None
    assert len(study.results()) == 16
    assert len(pruned) >= 3
    assert not any(pruned)


def test_a_job_waits_for_a_worker_that_is_about_to_let_go(tmp_path):
    path = tmp_path / "run"
    held = hold_run_folder(path, tiny(), ["test"])
    threading.Timer(0.7, held.close).start()
    patiently(lambda where: hold_run_folder(Path(where), tiny(), ["test"]).close(), path)
    held = hold_run_folder(path, tiny(), ["test"])
    with pytest.raises(InputError, match="in use"):
        patiently(lambda where: hold_run_folder(Path(where), tiny(), ["test"]), path, 0.0)
    held.close()


def test_what_a_job_waits_for_is_no_matter_of_words(tmp_path):
    errors = [InputError("the key is in use by nothing"), InUseError("besetzt")]

    def do(path):
        raise errors.pop()

    with pytest.raises(InputError, match="the key"):
        patiently(do, tmp_path)
    assert not errors  # waited for the one, and not for the other


def test_a_run_folder_whose_making_was_cut_short_is_made_again(tmp_path):
    path = tmp_path / "run"
    path.mkdir()
    (path / "config.yaml").write_text("seed: 0\n")
    (path / "lock").write_text("")
    hold_run_folder(path, tiny(), ["test"]).close()
    assert (path / "provenance.json").is_file()
    with pytest.raises(InputError, match="another configuration"):
        hold_run_folder(path, tiny(clip=0.1), ["test"])
    (tmp_path / "other").mkdir()
    (tmp_path / "other/thesis.tex").write_text("")
    with pytest.raises(InputError, match="not empty"):
        hold_run_folder(tmp_path / "other", tiny(), ["test"])


def test_a_worker_ends_in_order_though_it_watches_its_conductor(tmp_path):
    job, run = tmp_path / "job.json", tmp_path / "run"
    write_job(job, [run], [tiny().model_dump_json()], [{"measure": "held_out"}])
    write_json(outcome_file(run), asdict(Outcome("done", {"held_out": 0.5})))
    command = [sys.executable, "-m", "jaxleas.sweeps.job", str(job), LIFELINE]
    pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "stderr": subprocess.STDOUT}
    with subprocess.Popen(command, cwd=ROOT, **pipes) as process:
        assert process.stdout.read() == b""
        assert process.wait(60) == 0
