"""The files of a sweep's jobs: what a worker is to train, and how each training ended."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, Literal

from jaxleas.files import read_typed, write_json

STOP = "stop"  # suffix of a file next to the run folder: the trial is pruned


@dataclass(frozen=True)
class Outcome:
    """The end of one training.

    Attributes:
        state: state of the training: done, pruned or failed.
        values: values of the objectives, by name; empty unless done.
        reason: reason for a failure.
        seconds: training time, including resumed parts [s].
    """

    state: str
    values: dict[str, float]
    reason: str = ""
    seconds: float = 0.0


@dataclass(frozen=True)
class Training:
    """One training of a job.

    Attributes:
        run: absolute path of its run folder.
        config: run configuration as JSON.
    """

    run: str
    config: str


@dataclass(frozen=True)
class Job:
    """The content of a job's file.

    Attributes:
        trainings: trainings to run; several of them run as one population.
        objectives: objectives to measure, as plain JSON.
        version: version of the file's format.
    """

    trainings: list[Training]
    objectives: list[dict[str, Any]]
    version: Literal[1] = 1

    @property
    def runs(self) -> list[Path]:
        """Run folders of the trainings."""
        return [Path(each.run) for each in self.trainings]


def outcome_file(run: Path) -> Path:
    """Return the file of a training's outcome, next to its run folder."""
    return run.with_name(f"{run.name}.json")


def stop_file(run: Path) -> Path:
    """Return the file whose presence ends a training at its next examination."""
    return run.with_name(f"{run.name}.{STOP}")


def log_of(job: Path) -> Path:
    """Return the file with the output of a job's worker.

    Args:
        job: file of the job.
    """
    return job.with_suffix(".log")


def read_outcome(run: Path) -> Outcome | None:
    """Return a training's outcome; None while there is no file.

    Raises:
        InputError: the file is not an outcome.
    """
    path = outcome_file(run)
    if not path.is_file():
        return None
    return read_typed(Outcome, path, "outcome of a training")


def write_job(path: Path, runs: Sequence[Path], configs: Sequence[str], objectives: Any) -> None:
    """Write a job.

    Args:
        path: path of the file.
        runs: absolute paths of the run folders; several trainings run as one population.
        configs: run configurations of the trainings, as JSON.
        objectives: objectives to measure, as plain JSON.
    """
    pairs = zip(map(str, runs), configs, strict=True)
    write_json(path, asdict(Job([Training(*each) for each in pairs], objectives)))


def read_job(path: str | Path) -> Job:
    """Read a job.

    Raises:
        InputError: the file is not a job.
    """
    return read_typed(Job, path, "job of a sweep")
