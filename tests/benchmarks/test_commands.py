"""The command line: what is wrong with it is said in one sentence, with exit code 2."""

import json
import os
import subprocess
import sys

import pytest

from benchmarks import __main__ as command
from benchmarks.measurements import Figure, Metric, this_machine
from benchmarks.workloads import Workload
from jaxleas.cli_guard import run_guarded
from tests.training.runs import ROOT

METRIC = Metric("env_fake", "steps/s")
OTHER = "another machine"


@pytest.fixture
def fake(monkeypatch):
    """One workload whose speed a test sets."""
    speed = {"value": 100.0}
    workloads = (Workload((METRIC,), lambda context: {"env_fake": Figure([speed["value"]])}),)
    monkeypatch.setattr("benchmarks.suite.WORKLOADS", workloads)
    monkeypatch.setattr("benchmarks.suite.measure.__defaults__", (lambda _: None, workloads))
    return speed


def run(*arguments: str) -> int:
    return run_guarded(lambda: command.main(arguments))


def baseline(path, value: float, machine: str | None = None) -> str:
    entry = {
        **{"name": "env_fake", "value": value, "unit": "steps/s", "better": "higher"},
        **{"runs": [value], "machine": machine or this_machine()},
        **dict.fromkeys(("rival", "ratio", "limit", "of_limit")),
    }
    path.write_text(json.dumps([entry]))
    return str(path)


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (["--only", "envv_"], "did you mean env_"),
        (["--runs", "0"], "not a whole number above zero"),
        (["--runs", "many"], "not a whole number above zero"),
        (["--fast"], "unrecognized arguments: --fast"),
        (["--device", "abacus"], "invalid choice"),
        (["--rivals", "/nowhere/python"], "cannot be run as a Python"),
        (["--rivals", "--no-rivals"], "not allowed with"),
        (["--check", "--baseline", "/nowhere/base.json"], "does not exist"),
        (["--config", "/nowhere/config.yaml"], "does not exist"),
        (["--check", "--config", "configs/leas_p1_gpu.yaml"], "name its own --baseline"),
        (["--json", "/dev/null/out.json"], "cannot write"),
        (["--json", "a.json", "--into", "b.json"], "not allowed with"),
    ],
)
def test_wrong_commands(arguments, sentence, capsys):
    assert run(*arguments) == 2
    error = capsys.readouterr().err
    assert sentence in error
    assert error.count("\n") == 1


def test_a_missing_rival_is_said(tmp_path, capsys):
    bare = tmp_path / "python"  # a Python that has nothing but its own library
    bare.write_text(f'#!/bin/sh\nexec "{sys.executable}" -I -S "$@"\n')
    bare.chmod(0o755)
    assert run("--rivals", str(bare)) == 2
    error = capsys.readouterr().err
    assert "stable_baselines3" in error
    assert error.count("\n") == 1


def test_a_missing_device_is_said():
    done = subprocess.run(
        [sys.executable, "-m", "benchmarks", "--device", "gpu", "--only", "export_latency_1"],
        cwd=ROOT,
        capture_output=True,
        text=True,
        env={**os.environ, "JAX_PLATFORMS": ""},
        check=False,
    )
    if done.returncode == 0:
        pytest.skip("there is one here")
    assert done.returncode == 2
    assert done.stderr.splitlines()[-1].startswith("benchmarks: --device gpu: ")
    assert "Traceback" not in done.stderr


def test_one_table_and_one_file(fake, tmp_path, capsys):
    out = tmp_path / "out.json"
    assert run("--json", str(out), "--no-rivals") == 0
    (entry,) = json.loads(out.read_text())
    assert entry["name"] == "env_fake"
    assert entry["value"] == 100.0
    assert [path.name for path in tmp_path.iterdir()] == ["out.json"]
    assert "100 steps/s" in capsys.readouterr().out


@pytest.mark.parametrize(("speed", "code"), [(50.0, 1), (95.0, 0), (200.0, 0)])
def test_check_fails_only_where_slower(fake, tmp_path, speed, code, capsys):
    fake["value"] = speed
    path = baseline(tmp_path / "baseline.json", 100.0)
    assert run("--check", "--baseline", path, "--no-rivals") == code
    complaint = "worse than the baseline by more than the tolerance: env_fake"
    assert (complaint in capsys.readouterr().err) == (code == 1)
    assert run("--baseline", path, "--no-rivals") == 0, "without --check it only tells"


def test_a_baseline_from_elsewhere_is_told_and_not_checked(fake, tmp_path, capsys):
    path = baseline(tmp_path / "baseline.json", 100.0, OTHER)
    assert run("--baseline", path, "--no-rivals") == 0
    assert OTHER in capsys.readouterr().out
    assert run("--check", "--baseline", path, "--no-rivals") == 2


def test_pieces_are_put_into_one_file(fake, tmp_path, capsys):
    path = tmp_path / "pieces.json"
    assert run("--into", str(path), "--no-rivals") == 0, "a file that is not there is made"
    entry = json.loads(path.read_text())[0]
    path.write_text(json.dumps([entry | {"name": "env_other"}, entry]))
    fake["value"] = 300.0
    assert run("--into", str(path), "--no-rivals") == 0
    values = {each["name"]: each["value"] for each in json.loads(path.read_text())}
    assert values == {"env_fake": 300.0, "env_other": 100.0}
    path.write_text(json.dumps([entry | {"machine": OTHER}]))
    capsys.readouterr()
    assert run("--into", str(path), "--no-rivals") == 2
    assert "one file is of one machine" in capsys.readouterr().err
    assert json.loads(path.read_text())[0]["machine"] == OTHER


def test_listing_measures_nothing(capsys):
    assert run("--list", "--only", "learn_") == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines
    assert all(line.startswith("learn_") for line in lines)
