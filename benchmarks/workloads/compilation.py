"""Seconds to compile, and from process start to the first update, without and with the cache."""

import json
import tempfile
from pathlib import Path

from benchmarks.context import Context
from benchmarks.measurements import Figure, Metric
from benchmarks.workloads.processes import run
from benchmarks.workloads.workload import Workload

MOST_RUNS = 3  # each takes a fresh process and half a minute


def _measure(context: Context) -> dict[str, Figure]:
    found: dict[str, list[float]] = {metric.name: [] for metric in COMPILATION.metrics}
    words = ["-m", "benchmarks.workloads.first_update", str(context.config_path)]
    for _ in range(min(context.runs, MOST_RUNS)):
        with tempfile.TemporaryDirectory() as folder:
            for start in ("cold", "warm"):  # the first fills the cache for the second
                finished = run(words, Path(folder) / "cache", Path(folder) / "log")
                report = json.loads(finished.output.strip().splitlines()[-1])
                found[f"ppo_compile_{start}"].append(report["compile"])
                found[f"ppo_first_update_{start}"].append(report["done"] - finished.began)
    return {name: Figure(runs) for name, runs in found.items()}


COMPILATION = Workload(
    tuple(
        Metric(f"ppo_{what}_{start}", "s", better="lower", tolerance=0.15)
        for what in ("compile", "first_update")
        for start in ("cold", "warm")
    ),
    _measure,
)
