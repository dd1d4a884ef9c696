"""The content of a distilled run's folder, read from files alone, for its report."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from jaxleas.distillation.folder import DistillationFolder, read_begun_with
from jaxleas.distillation.round_result import RoundResult, best_of
from jaxleas.distillation.rounds_file import read_rounds
from jaxleas.evaluation import Evaluation, Figures, read_evaluation, read_figures, refined_name
from jaxleas.files import is_file
from jaxleas.labels import read_verdicts
from jaxleas.reports import printed_planners
from jaxleas.runs import read_metrics
from jaxleas.types import CAUSES, Cause, InputError, Verdict

FIGURES = "figures.json"
MOST_CAUSES = 3


@dataclass(frozen=True)
class FailureCount:
    """Failures with one cause.

    Attributes:
        count: number of the failures.
        cause: cause of the failures, described.
        example: reason of the first of them, a sentence.
    """

    count: int
    cause: str
    example: str


@dataclass(frozen=True)
class LabelCount:
    """Verdicts of one round.

    Attributes:
        round: number of the round.
        guides: number of guide paths judged.
        passed: number of those that the planner succeeded on.
        undecided: number of those without a verdict in time.
        seconds: mean planning time per guide path [s].
        failures: most frequent causes of failure, the most frequent one first.
    """

    round: int
    guides: int
    passed: int
    undecided: int
    seconds: float
    failures: tuple[FailureCount, ...]


@dataclass(frozen=True)
class Missing:
    """Something that a report would show, and how to make it."""

    what: str
    command: str


@dataclass
class RunData:
    """All data that a distilled run's report is made of.

    Attributes:
        path: path of the run.
        rounds: rows of rounds.json.
        labels: verdicts of each round.
        start: rows of the first training's metrics; empty where they are not available.
        practice: rows of each round's metrics, in order.
        evaluations: evaluations of suites, from RUN/evaluation.
        figures: figures from RUN/evaluation/figures.json.
        missing: descriptions of what was not there.
    """

    path: Path
    rounds: list[RoundResult]
    labels: list[LabelCount] = field(default_factory=list)
    start: list[dict[str, Any]] = field(default_factory=list)
    practice: list[list[dict[str, Any]]] = field(default_factory=list)
    evaluations: list[Evaluation] = field(default_factory=list)
    figures: Figures | None = None
    missing: list[Missing] = field(default_factory=list)

    @property
    def best(self) -> RoundResult:
        """Return the round whose policy is kept."""
        return best_of(self.rounds[1:] or self.rounds)


def is_distilled(run: Path) -> bool:
    """Return whether a folder is a distillation's."""
    return DistillationFolder(run).begun_with.is_file()


def read_run_data(run: Path, planner: str) -> RunData:
    """Read what is there, and list in `missing` what is not.

    Args:
        run: folder of the run.
        planner: planner of the run, for the commands that make what is missing.

    Raises:
        InputError: a file is there but cannot be read, or no round has been finished.
    """
    folder = DistillationFolder(run)
    if not folder.table.is_file():
        raise InputError(
            f"{run} has no rounds.json yet: no round is finished; resume it with jaxleas distill"
        )
    data = RunData(run, read_rounds(folder.table))
    for row in data.rounds:
        part = folder.round(row.round)
        if (part.labels / "verdicts").is_dir():
            data.labels.append(count_labels(row.round, part.labels / "verdicts"))
        if (part.run / "metrics.jsonl").is_file():
            data.practice.append(read_metrics(part.run / "metrics.jsonl"))
    where = read_begun_with(folder.begun_with)
    start = folder.start if where is None else Path(where)
    if is_file(start / "metrics.jsonl"):
        data.start = read_metrics(start / "metrics.jsonl")
    else:
        what = f"the first training's learning curve: {start} is not here"
        data.missing.append(Missing(what, "put that run folder back where it was"))
    _read_evaluations(data, run, start, planner)
    return data


def _read_evaluations(data: RunData, run: Path, start: Path, planner: str) -> None:
    folder = run / "evaluation"
    for file in sorted(folder.glob("*.json")) if folder.is_dir() else ():
        if file.name != FIGURES:
            data.evaluations.append(read_evaluation(file))
    name, printed = refined_name(planner), " ".join(printed_planners())
    policies = f"--policies {name}={run}/policy.npz"
    if not any(each.suite == "thesis" for each in data.evaluations):
        data.missing.append(
            Missing(
                "tables 4.1, 4.2, 4.3: no evaluation of the suite thesis",
                f"jaxleas evaluate {start} --suite thesis --planners {printed} {policies}"
                f" --json {folder}/thesis.json",
            )
        )
    if (folder / FIGURES).is_file():
        data.figures = read_figures(folder / FIGURES)
    else:
        data.missing.append(
            Missing(
                "figures 4.17, 5.6, 5.7, 5.8, 5.9: no figure file",
                f"jaxleas figures {start} {policies} --out {folder}/{FIGURES}",
            )
        )


def count_labels(number: int, folder: Path) -> LabelCount:
    """Count a round's verdicts.

    Raises:
        InputError: one of the files is not a verdict file.
    """
    verdicts = [verdict for _, verdict in read_verdicts(folder)]
    failures = [each for each in verdicts if each.decided and not each.success]
    return LabelCount(
        round=number,
        guides=len(verdicts),
        passed=sum(each.success for each in verdicts),
        undecided=sum(not each.decided for each in verdicts),
        seconds=sum(each.seconds for each in verdicts) / max(len(verdicts), 1),
        failures=most_frequent(failures),
    )


def most_frequent(failures: Sequence[Verdict]) -> tuple[FailureCount, ...]:
    """Count failures by their cause, the most frequent causes first.

    Failures without a cause, of files from before causes were recorded, count as "other".
    """
    grouped: dict[Cause, list[Verdict]] = {}
    for each in failures:
        grouped.setdefault(each.cause or "other", []).append(each)
    order = sorted(grouped, key=lambda cause: -len(grouped[cause]))[:MOST_CAUSES]
    return tuple(
        FailureCount(len(grouped[cause]), CAUSES[cause], grouped[cause][0].reason)
        for cause in order
    )
