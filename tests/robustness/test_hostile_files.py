"""Every reader takes what it is sent, or refuses it by one sentence: a few hundred of each."""

import json
import os
import subprocess
import sys

from tests.training.runs import ROOT, environment

INPUTS = 1200 if os.environ.get("CI") else 600


def test_mutated_files_of_every_kind_are_read_or_refused(tmp_path):
    result = tmp_path / "result.json"
    command = [
        sys.executable,
        "-m",
        "benchmarks.strangers",
        "--inputs",
        str(INPUTS),
        "--seed",
        "11",
    ]
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
    assert report["inputs"] == INPUTS
    assert report["failed"] == 0
    assert report["refused"] > 2 * INPUTS // 3
    assert report["accepted"] > INPUTS // 24
    assert len(report["kinds"]) >= 24
    assert report["slowest"]["seconds"] < 10
    assert report["hungriest"]["megabytes"] < 500
