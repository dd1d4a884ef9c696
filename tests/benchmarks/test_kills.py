"""A training killed at random moments, power cuts included, ends as if nothing had happened."""

import json
import subprocess
import sys

import pytest

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
