"""The commands `jaxleas evaluate` and `jaxleas report`."""

from pathlib import Path

from jaxleas.evaluation.examination import (
    examine,
    keep_evaluation,
    load_candidate,
    run_evaluations,
)
from jaxleas.evaluation.progress import Reporter
from jaxleas.evaluation.result_file import Evaluation, write_evaluation
from jaxleas.evaluation.stage import make_stage
from jaxleas.evaluation.suites import make_suite
from jaxleas.evaluation.table import plain_table
from jaxleas.types.errors import InputError


def evaluate(
    run: Path,
    suite: str = "transitions",
    starts: int | None = None,
    json: Path | None = None,
    baseline: bool = True,
    seed: int = 0,
) -> Evaluation:
    """Judge a policy on terrains it was never trained on, and print the table.

    Args:
        run: a run folder, a policy.npz or an .onnx file.
        suite: transitions, hole, wall, circuit or dead_end.
        starts: a cell; by default 1000 for transitions, 200 or 100 for the others.
        json: where to write the result as well; a run folder keeps the one of most starts in
            RUN/evaluation/.
        baseline: judge RB-Lin and RB-Kino beside it.
        seed: of scenes and starts; training never sees any of them.

    Raises:
        InputError: there is no such policy or suite, or a number is out of range.
    """
    make_suite(suite, starts=1)  # a misspelt name is told before anything is loaded
    if starts is not None and starts < 1:
        raise InputError(f"starts = {starts}: a cell needs at least 1 start")
    candidate = load_candidate(run)
    with Reporter() as reporter:
        evaluation = examine(candidate, suite, starts, seed, baseline, reporter.say)
    print(plain_table(evaluation))
    if Path(run).is_dir():
        keep_evaluation(Path(run), candidate, evaluation)
    if json is not None:
        write_evaluation(json, evaluation)
        print(f"written: {json}")
    return evaluation


def report(run: Path, out: Path | None = None) -> Path:
    """Write a run's report as one self-contained HTML file.

    Suites that the run was not judged on yet are judged first.

    Args:
        run: a run folder.
        out: where to write it; by default RUN/report.html.

    Raises:
        InputError: it is no run folder, or holds no policy yet.
    """
    from jaxleas.evaluation.report import write_report

    run = Path(run)
    if not run.is_dir():
        raise InputError(f"{run} is not a run folder: a report needs one, as train.py writes it")
    candidate = load_candidate(run)
    with Reporter() as reporter:
        stage = make_stage()
        evaluations = run_evaluations(candidate, run, stage, reporter.say)
        path = write_report(run, candidate, evaluations, stage, out, reporter.say)
    print(f"written: {path}")
    return path
