"""Train several seeds from random weights and judge each: the worst and the median of them.

python -m benchmarks.seeds [CONFIG] [--seeds 0 1 2 3 4] [--runs DIR] [--out SEEDS.json]
                           [--cells CELLS.json] [--suites NAME ...] [--starts N]

SEEDS.json holds one row per suite, the worst cell of the worst seed; CELLS.json every cell of every
seed. After an interruption the same command goes on: trainings resume, and what was judged is
kept, in the run folders DIR/seed_N.
"""

import argparse
import hashlib
import json
import statistics
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from benchmarks.measurements import this_machine, write_measurements
from benchmarks.seed_rows import rows_of_cells
from jaxleas.cli_guard import UsageError, run_guarded
from jaxleas.evaluation import SUITES, Evaluation, now, read_evaluation
from jaxleas.files import write_json
from jaxleas.terrain import noise_of
from jaxleas.training import RunConfig, load_run_config
from jaxleas.types import InputError

ROOT = Path(__file__).resolve().parents[1]
NOISY = "transitions_noise"
"""The suite `transitions`, where policy and guard see maps of sensors."""
NOISE = ("white=0.02", "missing=0.02", "quantisation=0.01")
"""What is wrong with these maps."""
JUDGED = ("transitions", "hole", "wall", "circuit", "dead_end", "limits", NOISY)
STARTS = 1000
"""Starts in each cell."""
MOST_AT_LIMITS = 200
"""Starts in each cell of limits, at most: each ten need the truth of another scene, which takes a
third of a second, and all of their configurations are judged on its polygons."""


@dataclass(frozen=True)
class Trained:
    """A training of one seed, judged.

    Attributes:
        seed: training seed.
        seconds: time that training took, without set-up and judging [s].
        evaluations: result of each suite.
    """

    seed: int
    seconds: float
    evaluations: tuple[Evaluation, ...]


class InterruptedBenchmarkError(InputError):
    """A training or an evaluation ended before it was done; the same command goes on."""


def main(arguments: Sequence[str]) -> None:
    """Train, judge, and write the file and the table."""
    given = _parser().parse_args(arguments)
    if len(set(given.seeds)) < len(given.seeds):
        raise UsageError(f"--seeds {' '.join(map(str, given.seeds))}: name each seed once")
    config = load_run_config(given.config)
    trained = [
        train_and_judge(given.config, given.runs / f"seed_{seed}", seed, given)
        for seed in given.seeds
    ]
    document = {
        "config": given.config.name,
        "steps": config.ppo.steps,
        "machine": this_machine(),
        "created": now(),
        "starts": given.starts,
        "seconds": {str(each.seed): each.seconds for each in trained},
        "cells": cells_of(trained),
    }
    write_json(given.cells, document)
    write_measurements(given.out, rows_of_cells(document["cells"], document["machine"]))
    print(table_of(document))


def train_and_judge(config: Path, run: Path, seed: int, given: argparse.Namespace) -> Trained:
    """Return a seed's results, from its run folder as far as it holds them.

    Args:
        config: configuration of the training.
        run: run folder of the seed.
        seed: training seed.
        given: options `suites` and `starts`.

    Raises:
        InterruptedBenchmarkError: training or judging ended before it was done.
    """
    if not (run / "config.yaml").exists():
        _run("train.py", config, "--seed", seed, "--run-dir", run, "--final.evaluate", "false")
    elif not is_trained(run):
        _run("train.py", "--resume", run)
    if load_run_config(run / "config.yaml").seed != seed:
        raise InputError(f"{run} holds another seed than {seed}: give another --runs DIR")
    for suite in given.suites:
        starts = starts_in(suite, given.starts)
        if kept(run, suite, starts) is None:
            options: tuple[object, ...] = ("--starts", starts, "--no-baseline")
            if suite == NOISY:
                options = (*options, "--json", _file(run, suite), "--noise", *NOISE)
            named = suite.removesuffix("_noise")
            _run("-m", "jaxleas.cli", "evaluate", run, "--suite", named, *options)
    found = [kept(run, suite, starts_in(suite, given.starts)) for suite in given.suites]
    return Trained(seed, rows_of(run)[-1]["seconds"], tuple(each for each in found if each))


def starts_in(suite: str, asked: int) -> int:
    """Return the number of starts in each cell of a suite, of which `asked` are asked for."""
    return min(asked, MOST_AT_LIMITS) if suite == "limits" else asked


def rows_of(run: Path) -> list[dict[str, Any]]:
    """Return the rows of a run's metrics that are whole; empty if there are none."""
    path = run / "metrics.jsonl"
    lines = path.read_text(encoding="utf-8").splitlines() if path.exists() else []
    return [json.loads(line) for line in lines if line.endswith("}")]


def is_trained(run: Path) -> bool:
    """Return whether a run has made all of its updates."""
    config: RunConfig = load_run_config(run / "config.yaml")
    rows = rows_of(run)
    return bool(rows) and rows[-1]["step"] >= config.ppo.updates * config.ppo.batch


def kept(run: Path, suite: str, starts: int) -> Evaluation | None:
    """Return a run's evaluation, if it is of the present policy and of as many starts."""
    path, policy = _file(run, suite), run / "policy.npz"
    if not path.exists():
        return None
    try:
        found = read_evaluation(path)
    except InputError:  # damaged, or of another version: it is made again
        return None
    same = found.fingerprint == hashlib.sha256(policy.read_bytes()).hexdigest()
    same &= found.noise == (noise_of(NOISE) if suite == NOISY else None)
    return found if same and all(cell.starts >= starts for cell in found.cells) else None


def cells_of(trained: Sequence[Trained]) -> list[dict[str, Any]]:
    """Return each cell with the numbers of every seed, their worst and their median.

    Success is the share of starts that reached the goal or, where the policy should stop, stayed
    valid; `low` and `high` are its 95 % Wilson interval.
    """
    cells: dict[tuple, dict[str, Any]] = {}
    for one in trained:
        for evaluation in one.evaluations:
            for cell in evaluation.cells:
                suite = evaluation.suite + "_noise" * (evaluation.noise is not None)
                key = suite, cell.name, cell.yaw
                entry = cells.setdefault(
                    key,
                    {
                        **{"suite": key[0], "name": key[1], "yaw": key[2]},
                        **{"expectation": cell.expectation, "seeds": {}},
                    },
                )
                success = cell.reached if cell.expectation == "cross" else 1.0 - cell.invalid
                entry["seeds"][str(one.seed)] = {
                    **{"starts": cell.starts, "reached": cell.reached, "invalid": cell.invalid},
                    **{"success": round(success, 6), "low": cell.low, "high": cell.high},
                }
    for entry in cells.values():
        for name, worst in (("success", min), ("invalid", max)):
            values = [each[name] for each in entry["seeds"].values()]
            entry[f"worst_{name}"] = worst(values)
            entry[f"median_{name}"] = statistics.median(values)
    return list(cells.values())


def table_of(document: dict[str, Any]) -> str:
    """Return the table of a results file, in Markdown."""
    lines = [
        f"{document['config']}, {len(document['seconds'])} seeds, {document['machine']}",
        "",
        "| suite | cell | heading | success: worst / median | invalid: worst / median |",
        "|---|---|---|---|---|",
    ]
    for cell in document["cells"]:
        numbers = (
            f"{100 * cell[f'worst_{name}']:.1f} / {100 * cell[f'median_{name}']:.1f} %"
            for name in ("success", "invalid")
        )
        lines.append(
            f"| {cell['suite']} | {cell['name']} | {cell['yaw']:.0f}° | {' | '.join(numbers)} |"
        )
    return "\n".join(lines)


def _file(run: Path, suite: str) -> Path:
    """Return where a run folder keeps its evaluation on a suite."""
    return run / "evaluation" / f"{suite}.json"


def _run(*words: object) -> None:
    done = subprocess.run([sys.executable, *map(str, words)], cwd=ROOT, check=False)
    if done.returncode:
        raise InterruptedBenchmarkError(
            f"{' '.join(map(str, words[:3]))} ended with exit code {done.returncode}: the same"
            " command goes on where it stopped"
        )


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="benchmarks.seeds", description=__doc__)
    parser.add_argument("config", nargs="?", type=Path, default=ROOT / "configs/leas_p1.yaml")
    parser.add_argument("--seeds", type=int, nargs="+", default=[0, 1, 2, 3, 4])
    parser.add_argument("--runs", type=lambda text: Path(text).absolute(), default=ROOT / "runs")
    parser.add_argument("--suites", nargs="+", choices=(*SUITES, NOISY), default=JUDGED)
    parser.add_argument("--starts", type=int, default=STARTS)
    results = ROOT / "benchmarks/results"
    parser.add_argument("--out", type=Path, default=results / "seeds.json")
    parser.add_argument("--cells", type=Path, default=results / "seeds_cells.json")
    return parser


if __name__ == "__main__":
    sys.exit(run_guarded(lambda: main(sys.argv[1:])))
