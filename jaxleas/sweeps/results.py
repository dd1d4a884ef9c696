"""The table of a sweep: one row per trial, in the terminal, as CSV and as JSON."""

import csv
import io
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from jaxleas.files import write_json, write_text
from jaxleas.sweeps.border import Sweep
from jaxleas.sweeps.config import Objective
from jaxleas.sweeps.objectives import is_maximised, never

VERSION = 1


@dataclass(frozen=True)
class TrialResult:
    """The result of one trial.

    Attributes:
        number: number of the trial, counted from 0.
        state: state of the trial: done, pruned or failed.
        params: values of the searched fields.
        values: values of the objectives, by name: means over the seeds; empty unless done.
        seeds: values of the objectives for each training, by seed.
        reason: reason for a failure.
        seconds: total time of its trainings [s].
    """

    number: int
    state: str
    params: dict[str, Any]
    values: dict[str, float]
    seeds: dict[str, dict[str, float]]
    reason: str = ""
    seconds: float = 0.0


def best_of(results: Sequence[TrialResult], objectives: Sequence[Objective]) -> list[TrialResult]:
    """Return the trials that no other beats in every objective, sorted by the first objective."""
    done = [each for each in results if each.state == "done"]

    def score(result: TrialResult) -> tuple[float, ...]:
        return tuple(
            result.values[each.name] if is_maximised(each) else -result.values[each.name]
            for each in objectives
        )

    def beaten(one: TrialResult) -> bool:
        mine = score(one)
        return any(
            all(a >= b for a, b in zip(score(other), mine, strict=True)) and score(other) != mine
            for other in done
        )

    front = [each for each in done if not beaten(each)]
    return sorted(front, key=score, reverse=True)


def ranked(results: Sequence[TrialResult], objectives: Sequence[Objective]) -> list[TrialResult]:
    """Return all trials in the order of a table: the best, then by the first objective."""
    first, front = objectives[0], best_of(results, objectives)
    sign = -1.0 if is_maximised(first) else 1.0
    others = [each for each in results if each not in front]
    others.sort(key=lambda each: (each.state != "done", sign * each.values.get(first.name, 0.0)))
    return [*front, *others]


def write_results(folder: Path, results: Sequence[TrialResult], sweep: Sweep) -> None:
    """Write results.json and results.csv.

    Raises:
        InputError: a file cannot be written.
    """
    best = [each.number for each in best_of(results, sweep.config.objectives)]
    write_json(
        folder / "results.json",
        {
            "version": VERSION,
            "sweep": sweep.name,
            "objectives": [each.model_dump(mode="json") for each in sweep.config.objectives],
            "best": best,
            "trials": [asdict(each) for each in results],
        },
    )
    write_text(folder / "results.csv", _csv(results, sweep))


def _csv(results: Sequence[TrialResult], sweep: Sweep) -> str:
    stream = io.StringIO()
    fields = list(sweep.config.space)
    names = [each.name for each in sweep.config.objectives]
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow(["trial", "state", *names, *fields, "seconds", "reason"])
    for each in results:
        values = [each.values.get(name, "") for name in names]
        params = [each.params.get(name, "") for name in fields]
        writer.writerow([each.number, each.state, *values, *params, each.seconds, each.reason])
    return stream.getvalue()


def plain_table(results: Sequence[TrialResult], sweep: Sweep, most: int = 40) -> str:
    """Return the table for a terminal: best trials first, then the others by number."""
    objectives = sweep.config.objectives
    total = float(sweep.base.ppo.updates * sweep.base.ppo.batch)
    front = best_of(results, objectives)
    headings = ["trial", "state", *(each.name for each in objectives), *sweep.config.space]
    lines = [headings]
    for each in ranked(results, objectives)[:most]:
        mark = "*" if each in front else ""
        shown = [shown_value(one, each.values.get(one.name), total) for one in objectives]
        params = [shown_param(each.params.get(name)) for name in sweep.config.space]
        lines.append([f"{each.number}{mark}", each.state, *shown, *params])
    widths = [max(len(line[column]) for line in lines) for column in range(len(headings))]
    rows = ["  ".join(t.rjust(w) for t, w in zip(line, widths, strict=True)) for line in lines]
    left_out = len(results) - (len(lines) - 1)
    end = [f"and {left_out} more, in results.csv"] if left_out > 0 else []
    return "\n".join([*rows, *end])


def shown_value(objective: Objective, value: float | None, total: float) -> str:
    """Return an objective's value as text for display."""
    if value is None:
        return "-"
    if is_maximised(objective):
        return f"{100 * value:.1f} %"
    if objective.measure == "seconds_to_success":
        return f"{value:.1f} s"
    return "never" if never(objective, value, total) else f"{value:,.0f}"


def shown_param(value: Any) -> str:
    """Return a searched field's value as text for display; empty if it was not drawn."""
    if value is None:
        return "-"
    return f"{value:.4g}" if isinstance(value, float) else str(value)
