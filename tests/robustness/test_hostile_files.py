"""Every reader takes what it is sent, or refuses it by one sentence: a few hundred of each."""

import json
import subprocess
import sys

from tests.training.runs import ROOT, environment


def test_mutated_files_of_every_kind_are_read_or_refused(tmp_path):
    result = tmp_path / "result.json"
    command = [sys.executable, "-m", "benchmarks.strangers", "--inputs", "1200", "--seed", "11"]
    process = subprocess.run(
        [*command, "--json", str(result)],
        cwd=ROOT,
        env=environment(1),
        capture_output=True,
        text=True,
        timeout=240,
    )
    assert process.returncode == 0, process.stdout + process.stderr
    report = json.loads(result.read_text())
    assert report["inputs"] == 1200
    assert report["failed"] == 0
    assert report["refused"] > 800
    assert report["accepted"] > 50
    assert len(report["kinds"]) >= 24
    assert report["slowest"]["seconds"] < 10
    assert report["hungriest"]["megabytes"] < 500
