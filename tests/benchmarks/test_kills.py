"""A training killed at random moments, power cuts included, ends as if nothing had happened."""

import json
import subprocess
import sys

import pytest

from benchmarks.kills.killing import differences
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


def test_an_interruptions_checkpoint_may_stand_in_the_place_of_an_older_one():
    whole = {"policy.npz": 1, "metrics": 2, "step_000000014080.npz": 3, "step_000000015360.npz": 4}
    found = {"policy.npz": 1, "metrics": 2, "step_000000014720.npz": 9, "step_000000015360.npz": 4}
    assert differences(whole, found) == []
    assert differences(whole, whole) == []
    assert differences(whole, found | {"step_000000015360.npz": 5}) == ["step_000000015360.npz"]
    assert differences(whole, found | {"policy.npz": 5}) == ["policy.npz"]
    del found["step_000000014720.npz"]
    assert differences(whole, found) == ["step_000000014080.npz"]
    older = {**whole, "step_000000012800.npz": 7}
    assert differences(whole, older) == ["step_000000012800.npz"]
    newest = {"policy.npz": 1, "metrics": 2, "step_000000014720.npz": 9}
    assert differences({**newest, "step_000000015360.npz": 4}, newest) == ["step_000000015360.npz"]
