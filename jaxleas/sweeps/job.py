"""The job of a sweep's worker: run one or several trainings, measure them, write outcomes.

A job is a file, and so is each outcome: a job without its outcomes is done again, from the existing
checkpoints. So a worker, or all of them, may be killed at any moment.
"""

import itertools
import os
import sys
import threading
import time
from collections.abc import Callable, Sequence
from dataclasses import asdict
from functools import partial
from pathlib import Path
from typing import Any

from jaxleas.files import InUseError, parse_json, typed, write_json
from jaxleas.sweeps.job_files import Outcome, outcome_file, read_job, stop_file
from jaxleas.types import JaxleasError, OwnCodeError

LIFELINE = "--lifeline"
ALLOW = "--allow"


class _PrunedError(JaxleasError):
    """The pruner has ended this training."""


def do_job(path: str | Path, allow: Sequence[str] = ()) -> None:
    """Do a job: each of its trainings has an outcome afterwards.

    Args:
        path: file of the job.
        allow: user's own code that may be run, as MODULE:CLASS; naming it in a file is not enough.

    Raises:
        InterruptedRunError: a signal asked to stop; everything done is saved.
    """
    from jaxleas.sweeps.config import Objective
    from jaxleas.training import parse_run_config

    job = read_job(path)
    runs = job.runs
    what = f"{path} is no job of a sweep"
    configs = [
        parse_run_config(parse_json(each.config, what), what, allow) for each in job.trainings
    ]
    objectives = typed(list[Objective], job.objectives, what)
    if all(outcome_file(run).is_file() for run in runs):
        return
    states = (
        _train_alone(runs[0], configs[0], allow)
        if len(runs) == 1
        else _train_together(Path(path).with_suffix(""), runs, configs, allow)
    )
    for run, config, (state, reason) in zip(runs, configs, states, strict=True):
        if not outcome_file(run).is_file():
            write_json(outcome_file(run), asdict(_outcome(run, config, objectives, state, reason)))


def _train_alone(run: Path, config: Any, allow: Sequence[str]) -> list[tuple[str, str]]:
    """Return state and reason of a training in its own program."""
    from jaxleas.sweeps.run_folders import hold_run_folder
    from jaxleas.training import NonFiniteError, train

    def look() -> None:
        if stop_file(run).is_file():
            raise _PrunedError(f"{run} was pruned")

    try:
        with hold_run_folder(run, config, sys.argv, allow) as folder:
            train(config, folder, on_examined=look, allow=allow)
    except _PrunedError:
        return [("pruned", "")]
    except (NonFiniteError, OwnCodeError) as error:  # it would fail again
        return [("failed", str(error))]
    return [("done", "")]


def _train_together(
    home: Path, runs: list[Path], configs: list[Any], allow: Sequence[str]
) -> list[tuple[str, str]]:
    """Return states and reasons of trainings in one program."""
    from jaxleas.sweeps.population_config import Members
    from jaxleas.sweeps.population_loop import train_population
    from jaxleas.training import make_task, rehearse

    members = Members(tuple(configs), tuple({} for _ in configs), allow=tuple(allow))
    try:
        rehearse(configs[0], make_task(configs[0], allow))
    except OwnCodeError as error:
        return [("failed", str(error)) for _ in configs]
    results = train_population(members, runs, home, sys.argv)
    return [("failed" if each.failure else "done", each.failure) for each in results]


def _outcome(run: Path, config: Any, objectives: Any, state: str, reason: str) -> Outcome:
    from jaxleas.runs import read_metrics
    from jaxleas.sweeps.objectives import measure

    metrics = run / "metrics.jsonl"
    rows = read_metrics(metrics) if metrics.is_file() else []
    seconds = rows[-1]["seconds"] if rows else 0.0
    if state != "done":
        return Outcome(state, {}, reason, seconds)
    total = config.ppo.updates * config.ppo.batch
    return Outcome("done", measure(run, objectives, total), "", seconds)


def _die_with_parent() -> None:
    """End this process when its parent is gone, which closes the other end of standard input."""

    def wait_for_the_end() -> None:
        # Not through `sys.stdin`: this thread would hold its lock, which prevents an orderly end.
        while os.read(0, 4096):
            pass
        os._exit(1)  # at once, as a kill would: everything needed is on disk

    threading.Thread(target=wait_for_the_end, daemon=True).start()


def work(path: str | Path, allow: Sequence[str] = ()) -> None:
    """Do a job in a process that has touched no device yet (`do_job`)."""
    from jaxleas.sweeps.devices import use_all_cores
    from jaxleas.xla import keep_compiled_programs

    if len(read_job(path).runs) > 1:
        use_all_cores()
    keep_compiled_programs()
    patiently(partial(do_job, allow=allow), path)


def patiently(function: Callable[[Any], None], path: str | Path, seconds: float = 90.0) -> None:
    """Do a job; wait while its run folder is still held by a worker that is about to end."""
    until = time.monotonic() + seconds
    while True:
        try:
            return function(path)
        except InUseError:
            if time.monotonic() > until:
                raise
            time.sleep(0.5)


def _allowed(arguments: Sequence[str]) -> list[str]:
    """Return what follows each --allow."""
    pairs = itertools.pairwise(arguments)
    return [value for option, value in pairs if option == ALLOW]


def main(arguments: Sequence[str]) -> int:
    """Do the job that the first argument names; return the exit code."""
    if LIFELINE in arguments:
        _die_with_parent()
    try:
        work(arguments[0], _allowed(arguments))
    except JaxleasError as error:  # into the job's log
        print(f"{type(error).__name__}: {error}")
        return getattr(error, "exit_code", 2)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
