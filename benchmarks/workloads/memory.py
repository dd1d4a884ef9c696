"""The peak memory of training: of the whole process, as the system counts it."""

import tempfile
from pathlib import Path

from benchmarks.context import Context
from benchmarks.measurements import Figure, Metric
from benchmarks.workloads.processes import run
from benchmarks.workloads.workload import Workload

UPDATES = 12  # with one examination and checkpoints among them
MOST_RUNS = 3


def _measure(context: Context) -> dict[str, Figure]:
    peaks = []
    with tempfile.TemporaryDirectory() as folder:
        for number in range(min(context.runs, MOST_RUNS)):
            words = [
                *("train.py", str(context.config_path)),
                *("--run-dir", f"{folder}/run_{number}"),
                *("--ppo.steps", str(UPDATES * context.config.ppo.batch)),
                *("--final.evaluate", "false"),
            ]
            cache, log = Path(folder) / f"cache_{number}", Path(folder) / "log"
            peaks.append(run(words, cache, log).peak)
    return {"ppo_peak_memory": Figure(peaks, rival=context.rival.figure("memory"))}


MEMORY = Workload((Metric("ppo_peak_memory", "MiB", better="lower"),), _measure)
