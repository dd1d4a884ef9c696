"""The objectives of trials, measured from a training's run folder."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from jaxleas.contacts import settings_from
from jaxleas.evaluation import exact_success, make_suite
from jaxleas.runs import POLICY_FILE, read_metrics
from jaxleas.sweeps.config import Exact, HeldOut, Objective, TimeToSuccess

SUCCESS = "held_out/reached"


def is_maximised(objective: Objective) -> bool:
    """Return whether higher is better, as for success but not for time."""
    return not isinstance(objective, TimeToSuccess)


def learning_curve(run: Path) -> list[tuple[int, float]]:
    """Return steps and held-out success at every examination so far."""
    metrics = run / "metrics.jsonl"
    rows = read_metrics(metrics) if metrics.is_file() else []
    return [(row["step"], row[SUCCESS]) for row in rows if row.get(SUCCESS) is not None]


def measure(run: Path, objectives: Sequence[Objective], total_steps: int) -> dict[str, float]:
    """Return each objective's value for a finished training, by name.

    Args:
        run: run folder of the training.
        objectives: objectives to measure.
        total_steps: number of steps of the training.

    Raises:
        InputError: the run folder lacks something.
    """
    values: dict[str, float] = {}
    for objective in objectives:
        if isinstance(objective, HeldOut):
            values[objective.name] = max(success for _, success in learning_curve(run))
        elif isinstance(objective, TimeToSuccess):
            values[objective.name] = time_to_success(run, objective, total_steps)
        else:
            values[objective.name] = _exact_success(run, objective)
    return values


def time_to_success(run: Path, objective: TimeToSuccess, total_steps: int) -> float:
    """Return the environment steps, or seconds, after which the success was first reached.

    If it never was, return the time of the whole training plus the part of it by which the best
    success fell short, so that the sampler still learns which trial came closer. A value above the
    time of the whole training therefore means *never*.
    """
    rows = [row for row in read_metrics(run / "metrics.jsonl") if row.get(SUCCESS) is not None]
    key = "step" if objective.measure == "steps_to_success" else "seconds"
    for row in rows:
        if row[SUCCESS] >= objective.success:
            return float(row[key])
    whole = float(total_steps if key == "step" else rows[-1]["seconds"])
    best = max(row[SUCCESS] for row in rows)
    return whole * (2.0 - best / objective.success)


def never(objective: Objective, value: float, total: float) -> bool:
    """Return whether a time means that the success was never reached."""
    return isinstance(objective, TimeToSuccess) and value > total


def _exact_success(run: Path, objective: Exact) -> float:
    """Return the mean share of starts that reach their goal with contacts all the way."""
    settings: Any = settings_from(objective.planner, **objective.parameters)
    suites = [make_suite(name, objective.starts, held_out=True) for name in objective.suites]
    return exact_success(run / POLICY_FILE, objective.planner, settings, suites)
