"""python -m benchmarks.kills.distilling [--seed 0] [--folder DIR] [--json FILE]

A small distillation, killed once in each of its stages (label, fit, practise, judge) and gone on
with; compared with one left in peace. Ends with exit code 1 if they differ.
"""

import argparse
import json
import os
import random
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import yaml

from benchmarks.tiny import tiny_training
from jaxleas.files import read_json, write_json
from jaxleas.files.npz import read_arrays
from jaxleas.labels import read_verdicts
from tests.robustness.kills.training import content

ROOT = Path(__file__).resolve().parents[3]
DISTILLATION = {
    "planner": "sampling",
    "parameters": {"samples": 2000},
    "rounds": 1,
    "collect": {"guides": 480, "steps": 60, "disturbances": [0.3, 0.9]},
    "fit": {"epochs": 2, "code": 8, "hidden": 4, "held_out": 0.5},
    "practice": {"steps": 640 * 8},
    "judge": {"suites": ["hole"], "starts": 8},
}
# A stage, and how one sees from outside that it is under way.
STAGES: dict[str, Callable[[Path], bool]] = {
    "label": lambda out: any((out / "round_1" / "labels").rglob("verdicts_*.json")),
    "fit": lambda out: (out / "round_1" / "labels" / "done.json").is_file(),
    "practise": lambda out: any((out / "round_1" / "run" / "checkpoints").glob("step_*.npz")),
    "judge": lambda out: (out / "round_1" / "practised.json").is_file(),
}


def main() -> int:
    """Parse the command line, distil, kill, compare."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.kills.distilling")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--folder", type=Path, help="to work in; by default a temporary one")
    parser.add_argument("--json", type=Path, help="where to write the result")
    given = parser.parse_args()
    with tempfile.TemporaryDirectory() as temporary:
        folder = (given.folder or Path(temporary)).resolve()
        folder.mkdir(parents=True, exist_ok=True)
        report = _compare(folder, random.Random(given.seed))
    print(json.dumps(report, indent=2))
    if given.json:
        write_json(given.json, report)
    return 0 if report["equal"] else 1


def _compare(folder: Path, draw: random.Random) -> dict[str, object]:
    training = tiny_training()
    training["terrain"]["arenas"] = 6
    (folder / "start.yaml").write_text(yaml.safe_dump(training))
    (folder / "distil.yaml").write_text(yaml.safe_dump(DISTILLATION))
    start = folder / "start"
    _end(_start(folder, "train.py", str(folder / "start.yaml"), "--run-dir", str(start)))
    words = ["-m", "jaxleas.cli", "distill", str(folder / "distil.yaml"), "--start", str(start)]
    whole, killed = folder / "whole", folder / "killed"
    _end(_start(folder, *words, "--out", str(whole)))
    hits = []
    for stage, is_under_way in STAGES.items():
        process = _start(folder, *words, "--out", str(killed))
        while not is_under_way(killed) and process.poll() is None:
            time.sleep(0.002)
        time.sleep(draw.uniform(0.0, 0.5))
        if process.poll() is None:
            os.killpg(process.pid, signal.SIGKILL)
            hits.append(stage)
        process.wait()
    _end(_start(folder, *words, "--out", str(killed)))
    first, second = _content(whole), _content(killed)
    differ = sorted(name for name in first if first[name] != second[name])
    return {
        "command": "python -m benchmarks.kills.distilling",
        "killed_in": hits,
        "compared": sorted(first),
        "differ": differ,
        "equal": not differ and len(hits) == len(STAGES),
    }


def _start(folder: Path, *words: str) -> subprocess.Popen:
    cache = {"JAX_COMPILATION_CACHE_DIR": str(folder / "xla"), "JAX_PLATFORMS": "cpu"}
    paths = {"PYTHONPATH": str(ROOT), "CI": "true"}
    log = (folder / "log").open("a")
    return subprocess.Popen(
        [sys.executable, *words],
        cwd=ROOT,
        env=os.environ | cache | paths,
        stdout=log,
        stderr=log,
        start_new_session=True,
    )


def _end(process: subprocess.Popen) -> None:
    if process.wait() != 0:
        raise RuntimeError(f"a process that nobody killed ended with {process.returncode}")


def _content(out: Path) -> dict[str, object]:
    """Return all that a distillation has come to, but for wall time."""
    first = out / "round_1"
    arrays = read_arrays(first / "surrogate.npz")
    verdicts = [verdict.__dict__ | {"seconds": 0} for _, verdict in read_verdicts(first / "labels")]
    judged = read_json(first / "judged.json")
    return {
        "verdicts": verdicts,
        "surrogate": {name: each.tobytes() for name, each in arrays.items()},
        "practice": content(first / "run"),
        "judged": judged["cells"],
        "policy": {name: each.tobytes() for name, each in read_arrays(out / "policy.npz").items()},
    }


if __name__ == "__main__":
    sys.exit(main())
