"""A training killed at random moments, power cuts included, ends as if nothing had happened."""

import json
import subprocess
import sys

import pytest

from tests.robustness.kills.killing import differences
from tests.training.runs import ROOT, environment


@pytest.mark.slow
def test_killed_at_random_moments_a_run_ends_bitwise_equal(tmp_path):
    result = tmp_path / "result.json"
    command = [sys.executable, "-m", "benchmarks.kills", "--kills", "4", "--seed", "3"]
    process = subprocess.run(
        [*command, "--folder", str(tmp_path / "work"), "--json", str(result)],
        cwd=ROOT,
        env=environment(1),
        capture_output=True,
        text=True,
        timeout=500,
    )
    assert process.returncode == 0, process.stdout + process.stderr
    report = json.loads(result.read_text())
    assert report["kills"] == 4
    assert report["runs_ended"] == report["runs_bitwise_equal"] >= 1
    assert report["corrupt_folders"] == 0


def test_what_an_interrupted_run_may_leave_otherwise():
    first, second, last = (f"step_{step:012d}.npz" for step in (12800, 14080, 15360))
    between = "step_000000014720.npz"  # where an interruption came, at no examination
    every = {first: 2, second: 3, last: 4}
    whole = {"policy.npz": 1, "metrics": 2, second: 3, last: 4}
    saved = {"policy.npz": 1, "metrics": 2, between: 9, last: 4}
    for found in (whole, saved, whole | {first: 2}, whole | {between: 9}):
        assert differences(whole, found, every) == []
    for name in ("policy.npz", last):
        assert differences(whole, saved | {name: 7}, every) == [name]
        assert differences(whole, {k: v for k, v in saved.items() if k != name}, every) == [name]
    assert differences(whole, whole | {first: 7}, every) == [first]
    assert differences(whole, whole | {"other": 1}, every) == ["other"]
    assert differences(whole, {k: v for k, v in whole.items() if k != second}, every) == [second]
