"""Two tasks of thirty lines train, are killed, resume, are swept and exported as steering is."""

import json
import os
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import onnxruntime
import pytest

from jaxleas import cli
from jaxleas.runs.checkpoints import Checkpoints
from jaxleas.runs.metrics import read_metrics
from jaxleas.training.policy import read_policy
from jaxleas.training.run_config import load_run_config, make_task
from jaxleas.training.trainer import Trainer
from jaxleas.types import InputError

from .configs import DRIFT, MAZE, write

ROOT = Path(__file__).resolve().parents[2]
BOTH = pytest.mark.parametrize("task", [pytest.param(DRIFT, marks=pytest.mark.slow), MAZE])


def train(*arguments: object, **options) -> subprocess.CompletedProcess:
    command = [sys.executable, "train.py", "--devices", "1", *map(str, arguments)]
    # It runs for longer than it compiles.
    flags = os.environ["XLA_FLAGS"].replace("optimization_level=0", "optimization_level=1")
    environment = os.environ | {"PYTHONPATH": str(ROOT), "CI": "true", "XLA_FLAGS": flags}
    return subprocess.run(
        command, cwd=ROOT, env=environment, capture_output=True, text=True, **options
    )


class Runs(dict):
    """Run folders of the probes, each trained and exported when it is first asked for."""

    def __init__(self, folder: Path) -> None:
        super().__init__()
        self.folder = folder

    def __missing__(self, task: str) -> Path:
        self[task] = self.folder / task.rpartition(":")[2]
        done = train(write(self.folder, task), "--run-dir", self[task], "--allow", task)
        assert done.returncode == 0, done.stderr
        return self[task]


@pytest.fixture(scope="module")
def runs(tmp_path_factory) -> Runs:
    """Both probes, trained by the command that trains steering."""
    return Runs(tmp_path_factory.mktemp("probes"))


@BOTH
def test_it_learns_its_task(runs, task):
    rows = read_metrics(runs[task] / "metrics.jsonl")
    reached = [row["held_out/reached"] for row in rows if "held_out/reached" in row]
    assert max(reached) > 0.7
    goals = [row["walk/goals_per_1000_steps"] for row in rows]
    assert max(goals) > 1.5 * goals[0]
    if task == DRIFT:
        assert {"held_out/reached/near", "held_out/reached/far", "walk/distance"} <= rows[-1].keys()


@BOTH
def test_its_policy_leaves_as_onnx_with_named_parts(runs, task):
    policy = read_policy(runs[task] / "policy.npz", allow=[task])
    session = onnxruntime.InferenceSession(str(runs[task] / "policy.onnx"))
    ports = {each.name: each.shape[1:] for each in session.get_inputs()}
    outputs = {each.name: each.type for each in session.get_outputs()}
    if task == DRIFT:  # what only the critic sees is no input
        assert ports == {"offset": [2]}
        assert outputs == {"velocity": "tensor(float)"}
    else:
        assert ports == {"goal_map": [7, 7], "bias": [1]}
        assert outputs == {"direction": "tensor(int64)"}
    shown = {
        name: np.random.default_rng(0).normal(size=(5, *shape)).astype(np.float32)
        for name, shape in ports.items()
    }
    (answer,) = session.run(None, shown)
    given = shown if len(shown) > 1 else next(iter(shown.values()))
    np.testing.assert_allclose(answer, policy(given), atol=1e-5)
    about = json.loads((runs[task] / "export.json").read_text())["metadata"]
    assert about["task"] == task


@pytest.mark.slow
@BOTH
def test_killed_and_resumed_it_ends_as_if_never_killed(runs, task, tmp_path):
    folder = tmp_path / "killed"
    command = [sys.executable, "train.py", "--devices", "1", str(write(tmp_path, task))]
    command += ["--run-dir", str(folder), "--allow", task]
    # It runs for longer than it compiles.
    flags = os.environ["XLA_FLAGS"].replace("optimization_level=0", "optimization_level=1")
    environment = os.environ | {"PYTHONPATH": str(ROOT), "CI": "true", "XLA_FLAGS": flags}
    process = subprocess.Popen(command, cwd=ROOT, env=environment, stderr=subprocess.DEVNULL)
    checkpoints = folder / "checkpoints"
    while process.poll() is None and len(list(checkpoints.glob("step_*.npz"))) < 2:
        time.sleep(0.02)
    process.send_signal(signal.SIGKILL)
    process.wait()
    again = train("--resume", folder, "--allow", task)
    assert again.returncode == 0, again.stderr
    for name in ("policy.npz", "policy.onnx"):
        assert (folder / name).read_bytes() == (runs[task] / name).read_bytes()
    both = [read_metrics(each / "metrics.jsonl") for each in (folder, runs[task])]
    for row in (*both[0], *both[1]):
        row.pop("seconds")
    assert both[0] == both[1]


@BOTH
def test_code_that_a_file_alone_names_is_never_run(runs, task, tmp_path):
    for arguments in (
        (write(tmp_path, task), "--run-dir", tmp_path / "r"),
        ("--resume", runs[task]),
    ):
        refused = train(*arguments)
        assert refused.returncode == 2
        assert f"--allow {task}" in refused.stderr
        assert refused.stderr.count("\n") == 1
    assert not (tmp_path / "r").exists()
    with pytest.raises(InputError, match=f"--allow {task}"):
        cli.run(["export", str(runs[task]), "--out", str(tmp_path / "out")])
    with pytest.raises(InputError, match=r"of the task tests\.probes\S+; one of steering"):
        cli.run(["evaluate", str(runs[task])])


@BOTH
def test_it_is_listed_beside_the_runs_of_steering(runs, task, capsys):
    cli.run(["runs", str(runs[task].parent)])
    assert runs[task].name in capsys.readouterr().out


def test_an_unknown_task_gets_the_nearest_right_name(tmp_path):
    (tmp_path / "typo.yaml").write_text("env: {task: sterring}\n")
    refused = train(tmp_path / "typo.yaml")
    assert refused.returncode == 2
    assert "typo.yaml: env.task: there is no task 'sterring'; perhaps you meant steering" in (
        refused.stderr
    )


@pytest.mark.slow
@BOTH
def test_it_is_swept(task, tmp_path):
    base = write(tmp_path, task)
    searched = "fuel" if task == DRIFT else "haste"
    (tmp_path / "sweep.yaml").write_text(
        f"config: {base.name}\n"
        "set: {ppo.steps: 8192, held_out.every: 2}\n"
        f"space: {{env.{searched}: {{low: 0.0, high: 0.3}}}}\n"
        "trials: 2\nvectorised: auto\nmembers: 2\n"
    )
    out = tmp_path / "out"
    command = ["sweep", str(tmp_path / "sweep.yaml"), "--out", str(out), "--allow", task]
    monkey = os.environ.get("PYTHONPATH")
    os.environ["PYTHONPATH"] = str(ROOT)  # what jobs in other processes import
    try:
        cli.run(command)
    finally:
        if monkey is None:
            os.environ.pop("PYTHONPATH")
        else:
            os.environ["PYTHONPATH"] = monkey
    results = json.loads((out / "results.json").read_text())
    trials = results["trials"] if isinstance(results, dict) else results
    assert [each["state"] for each in trials] == ["done", "done"]


def test_a_population_of_a_task_on_the_host_is_refused_with_one_sentence(tmp_path):
    (tmp_path / "population.yaml").write_text(
        f"config: {write(tmp_path, MAZE).name}\nseeds: [0, 1]\n"
    )
    command = ["population", str(tmp_path / "population.yaml"), "--out", str(tmp_path / "out")]
    with pytest.raises(InputError, match=r"steps on the host.*jaxleas sweep") as refusal:
        cli.run([*command, "--allow", MAZE])
    assert "\n" not in str(refusal.value)
    assert not (tmp_path / "out").exists()


def test_the_state_of_a_host_task_comes_back_from_a_checkpoint(tmp_path, brax_ranks):
    """It is NumPy's, in its own types."""
    config = load_run_config(write(tmp_path, MAZE), allow=[MAZE])
    trainer = Trainer(config, make_task(config, [MAZE]))
    state = trainer.fresh_state()
    assert state.episode["place"].dtype == np.int64
    checkpoints = Checkpoints(tmp_path / "checkpoints")
    checkpoints.save(1, state, {})
    _, again, _ = checkpoints.latest(trainer.shapes)
    assert isinstance(again.episode["place"], np.ndarray)
    np.testing.assert_array_equal(again.episode["place"], state.episode["place"])
    first, _ = trainer.train_step(trainer.world, state)
    second, _ = trainer.train_step(trainer.world, again)
    np.testing.assert_array_equal(first.episode["place"], second.episode["place"])
    np.testing.assert_array_equal(first.observation, second.observation)


@pytest.mark.slow
def test_the_task_of_the_documentation_trains(tmp_path):
    """The page's own files, by the page's own command."""
    page = (ROOT / "docs/your_own_task.md").read_text(encoding="utf-8")
    for name, body in re.findall(r"<!-- file: (\S+) -->\n```\w+\n(.*?)^```", page, re.M | re.S):
        (tmp_path / name).write_text(body)
    command = [sys.executable, ROOT / "train.py", "stride.yaml", "--run-dir", "runs/stride"]
    # It runs for longer than it compiles.
    flags = os.environ["XLA_FLAGS"].replace("optimization_level=0", "optimization_level=1")
    environment = os.environ | {"PYTHONPATH": str(ROOT), "CI": "true", "XLA_FLAGS": flags}
    done = subprocess.run(
        [*map(str, command), "--allow", "stride:Stride", "--devices", "1"],
        cwd=tmp_path,
        env=environment,
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr
    rows = read_metrics(tmp_path / "runs/stride/metrics.jsonl")
    assert max(row.get("held_out/reached") or 0.0 for row in rows) > 0.95
    session = onnxruntime.InferenceSession(str(tmp_path / "runs/stride/policy.onnx"))
    (step,) = session.run(None, {"ahead": np.array([[3.0]], np.float32)})
    assert 0.0 <= step[0, 0] <= 0.4
