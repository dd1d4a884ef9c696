"""Run folders made by hand: small, and as a training leaves them."""

import json
from pathlib import Path

from jaxleas.configuration.loading import to_yaml
from jaxleas.evaluation.result_file import CellResult, Evaluation, write_evaluation
from jaxleas.evaluation.statistics import wilson_interval
from jaxleas.runs.folder import RunFolder
from jaxleas.training.run_config import run_config_of

STARTS = 200
PPO = {"steps": 8000, "environments": 50, "unroll": 20, "minibatches": 2}


def make_run(path: Path, updates: int = 8, reached: float = 0.9, **config) -> Path:
    """Write a run of 1000 steps an update that examined every second one."""
    settled = run_config_of("steering").model_validate(
        {"ppo": PPO | config.pop("ppo", {}), **config}
    )
    with RunFolder.create(path, to_yaml(settled), ["train.py", "configs/leas_p1.yaml"]):
        rows = [
            {"step": 1000 * n, "seconds": 10.0 * n, "walk/reward": 0.1 * n}
            | ({"held_out/reached": reached * n / 8} if n % 2 == 0 else {})
            for n in range(1, updates + 1)
        ]
        lines = [json.dumps(row) + "\n" for row in rows]
        (path / "metrics.jsonl").write_text("".join(lines))
        (path / "policy.npz").write_bytes(b"")
    return path


def judge(path: Path, successes: dict[str, int], suite: str = "transitions") -> None:
    """Write the result of a suite: so many of 200 starts in each cell, beside a baseline."""
    cells = []
    for name, good in successes.items():
        for method, count in (("leas_p1", good), ("rb_lin", 0)):
            low, high = wilson_interval(count, STARTS)
            share = count / STARTS
            fractions = {"reached": share, "invalid": 1.0 - share, "stopped": 0.0}
            place = {"name": name, "yaw": 0.0, "method": method, "starts": STARTS}
            cells.append(CellResult(**place, **fractions, low=low, high=high))
    result = Evaluation(
        suite=suite, policy="p", robot="talos", seed=0, created="now", cells=tuple(cells)
    )
    write_evaluation(path / "evaluation" / f"{suite}.json", result)
