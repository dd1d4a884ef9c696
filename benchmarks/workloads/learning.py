"""Seconds from the start of `train.py` to a success rate on held-out terrain, one run per seed."""

import subprocess
import tempfile
import time
from pathlib import Path

from benchmarks.context import Context
from benchmarks.measurements import Figure, Metric
from benchmarks.workloads.processes import require_success, start
from benchmarks.workloads.workload import Workload
from jaxleas.runs import read_metrics

LEVELS = {"learn_seconds_to_95_percent": 0.95, "learn_seconds_to_99_percent": 0.99}
BEST, SECONDS_TO_BEST = "learn_best_success", "learn_seconds_to_best"
MOST_RUNS = 3
POLL = 0.1  # time between two looks at the metrics [s]


def _measure(context: Context) -> dict[str, Figure]:
    found: dict[str, list[float | None]] = {metric.name: [] for metric in LEARNING.metrics}
    with tempfile.TemporaryDirectory() as folder:
        for seed in range(min(context.runs, MOST_RUNS)):
            curve = learning_curve(context.config_path, Path(folder), seed)
            for name, level in LEVELS.items():
                found[name].append(next((when for when, share in curve if share >= level), None))
            best = max(share for _, share in curve)
            found[BEST].append(best)
            found[SECONDS_TO_BEST].append(next(when for when, share in curve if share == best))
    limits = {BEST: 1.0}
    return {name: Figure(runs, limits.get(name)) for name, runs in found.items()}


def learning_curve(config: Path, folder: Path, seed: int) -> list[tuple[float, float]]:
    """Train with one seed; return (seconds since process start, held-out success).

    The seeds share the compile cache, as a user's runs do: the first run is cold.
    """
    run_dir = folder / f"run_{seed}"
    words = ["train.py", str(config), "--run-dir", str(run_dir), "--seed", str(seed)]
    words += ["--final.evaluate", "false"]
    curve: list[tuple[float, float]] = []
    begin = time.perf_counter()
    process = start(words, folder / "cache", folder / "log")
    ended = False
    while not ended:
        ended = _has_ended(process)
        path = run_dir / "metrics.jsonl"
        rows = read_metrics(path) if path.is_file() else []
        shares = [row["held_out/reached"] for row in rows if "held_out/reached" in row]
        curve += [(time.perf_counter() - begin, share) for share in shares[len(curve) :]]
    require_success(process.returncode, words, (folder / "log").read_text(encoding="utf-8"))
    return curve


def _has_ended(process: subprocess.Popen) -> bool:
    try:
        process.wait(POLL)
    except subprocess.TimeoutExpired:
        return False
    return True


LEARNING = Workload(
    (
        *(Metric(name, "s", better="lower", tolerance=0.25, quick=False) for name in LEVELS),
        Metric(SECONDS_TO_BEST, "s", better="lower", tolerance=0.5, quick=False),
        Metric(BEST, "fraction", tolerance=0.02, quick=False),
    ),
    _measure,
)
