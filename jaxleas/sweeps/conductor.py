"""The conductor of a sweep: it assigns jobs, watches learning curves and reports results.

The conductor alone writes to the storage. Workers write files; the files on disk determine what
remains to be done, so that a kill of any worker, or of the conductor, loses nothing that was saved
and counts nothing twice.
"""

import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

from pydantic import TypeAdapter

from jaxleas.files import write_json, write_text
from jaxleas.runs import Interruption
from jaxleas.sweeps.border import Sweep
from jaxleas.sweeps.config import Objective
from jaxleas.sweeps.folder import SweepFolder
from jaxleas.sweeps.job_files import Outcome, outcome_file, read_job, stop_file, write_job
from jaxleas.sweeps.objectives import learning_curve
from jaxleas.sweeps.open_trial import OpenTrial, result_of
from jaxleas.sweeps.results import TrialResult, write_results
from jaxleas.sweeps.runners import Runner
from jaxleas.sweeps.study import Study
from jaxleas.types import InputError, JaxleasError

MOST_DEATHS = 3
"""Deaths of workers on the same job without a new examination after which it counts as failed."""
PAUSE = 0.25  # between two checks of the workers [s]


class InterruptedSweepError(JaxleasError):
    """The sweep was asked to stop; everything done so far is saved."""

    exit_code = 130


@dataclass
class Conductor:
    """One session of a sweep.

    Attributes:
        sweep: sweep to conduct.
        folder: folder of the sweep, held by this process.
        study: study that stores the trials.
        runner: runner that does the jobs.
        on_change: function that is called with all results so far whenever something changed.
    """

    sweep: Sweep
    folder: SweepFolder
    study: Study
    runner: Runner
    on_change: Callable[[list[TrialResult], int], None] = lambda results, running: None
    _open: dict[int, OpenTrial] = field(default_factory=dict)
    _flying: set[Path] = field(default_factory=set)
    _deaths: dict[Path, tuple[int, int]] = field(default_factory=dict)
    _batches: dict[Path, list[int]] = field(default_factory=dict)

    def run(self) -> list[TrialResult]:
        """Continue to the end; return the results of all trials.

        Raises:
            InterruptedSweepError: a signal asked to stop.
        """
        with Interruption() as interruption:
            try:
                for trial in self.study.open_trials():
                    self._begin(trial)
                self._find_batches()
                self._report_finished()
                while not interruption.requested:
                    self._hand_out()
                    if not self._flying and not self._open:
                        return self._keep()
                    time.sleep(PAUSE)
                    self._collect()
            finally:
                self.runner.close()
        self._report_finished()
        done, all_ = len(self._keep()), self.sweep.config.trials
        raise InterruptedSweepError(
            f"interrupted with {done} of {all_} trials done; all is saved: the same command resumes"
        )

    def _begin(self, trial: Any) -> None:
        """Draw a trial's values; a trial whose values do not fit each other fails at once."""
        values = self.study.draw(trial)
        try:
            configs = {
                seed: self.sweep.run_config(values, seed) for seed in self.sweep.config.seeds
            }
        except InputError as error:
            self.study.tell(trial, TrialResult(trial.number, "failed", values, {}, {}, str(error)))
            self._keep()
            return
        reported = self.study.reported(trial)
        self._open[trial.number] = OpenTrial(trial, values, configs, self.folder, reported)

    def _hand_out(self) -> None:
        """Give the runner jobs while it has room and jobs remain."""
        jobs = self._batch_jobs() if self.sweep.vectorised else self._single_jobs()
        while self.runner.free > 0:
            job = next(jobs, None)
            if job is None:
                return
            self._flying.add(job)
            self.runner.start(job)

    def _single_jobs(self) -> Iterator[Path]:
        """Yield jobs of one training each: open trials first, then new ones."""
        for each in list(self._open.values()):
            yield from self._next_of(each)
        while (trial := self.study.ask()) is not None:
            self._begin(trial)
            if trial.number in self._open:
                yield from self._next_of(self._open[trial.number])

    def _next_of(self, each: OpenTrial) -> Iterator[Path]:
        """Yield the jobs of a trial that can begin: that of its first seed, then all the others.

        So the curve of the first seed can end the trial before the others cost anything.
        """
        outcomes = each.outcomes()
        first, *others = each.configs
        if any(outcome.state != "done" for outcome in outcomes.values()):
            return  # pruned or failed: nothing more to learn
        for seed in others if first in outcomes else (first,):
            job = each.run(seed).with_suffix(".job.json")
            if seed not in outcomes and job not in self._flying:
                self._write_job(job, [(each, seed)])
                yield job

    def _batch_jobs(self) -> Iterator[Path]:
        """Yield jobs of several trials in one program: started batches first, then new ones."""
        for job, numbers in list(self._batches.items()):
            if job not in self._flying and any(number in self._open for number in numbers):
                yield job
        while True:
            batched = {number for numbers in self._batches.values() for number in numbers}
            free = [each for number, each in self._open.items() if number not in batched]
            size = max(1, self.sweep.config.members // len(self.sweep.config.seeds))
            while len(free) < size and (trial := self.study.ask()) is not None:
                self._begin(trial)
                if trial.number in self._open:
                    free.append(self._open[trial.number])
            if not free:
                return
            batch = free[:size]
            job = self.folder.batch(batch[0].number)
            self._write_job(job, [(each, seed) for each in batch for seed in each.configs])
            self._batches[job] = [each.number for each in batch]
            yield job

    def _find_batches(self) -> None:
        """Find the batches that were started before."""
        for job in sorted(self.folder.batch(0).parent.glob("[0-9]*.json")):
            runs = read_job(job).runs
            self._batches[job] = sorted({int(run.parent.name) for run in runs})

    def _write_job(self, job: Path, trainings: Sequence[tuple[OpenTrial, int]]) -> None:
        objectives = TypeAdapter(list[Objective]).dump_python(
            list(self.sweep.config.objectives), mode="json"
        )
        runs = [each.run(seed) for each, seed in trainings]
        configs = [each.configs[seed].model_dump_json() for each, seed in trainings]
        if not job.is_file():
            write_job(job, runs, configs, objectives)

    def _collect(self) -> None:
        """Process ended jobs and learning curves."""
        changed = False
        for job, words in self.runner.ended():
            self._flying.discard(job)
            changed = True
            runs = read_job(job).runs
            if all(outcome_file(run).is_file() for run in runs):
                continue
            if self._count_death(job, runs):
                self._give_up(runs, words)
        self._watch_curves()
        if changed:
            self._report_finished()

    def _count_death(self, job: Path, runs: Sequence[Path]) -> bool:
        """Count the death of a job's worker; return whether too many died without progress."""
        progress = sum(len(learning_curve(run)) for run in runs)
        before, deaths = self._deaths.get(job, (-1, 0))
        deaths = deaths + 1 if progress <= before else 1
        self._deaths[job] = progress, deaths
        return deaths >= MOST_DEATHS

    def _give_up(self, runs: Sequence[Path], words: str) -> None:
        reason = f"{MOST_DEATHS} workers ended over it and got no further, the last with {words}"
        for run in runs:
            if not outcome_file(run).is_file():
                write_json(outcome_file(run), asdict(Outcome("failed", {}, reason)))

    def _watch_curves(self) -> None:
        """Report new examinations of first seeds; stop the trials that the pruner ends."""
        if self.sweep.config.pruner == "none":
            return
        for each in self._open.values():
            run = each.run(next(iter(each.configs)))
            ended = outcome_file(run).is_file()
            curve = learning_curve(run)
            for examination in range(each.reported, len(curve)):
                each.reported = examination + 1
                prune = self.study.report(each.trial, examination + 1, curve[examination][1])
                if prune and not ended and not each.pruned:
                    each.pruned = True
                    write_text(stop_file(run), "")

    def _report_finished(self) -> None:
        """Report the trials whose trainings have all ended to the study."""
        for number, each in list(self._open.items()):
            result = result_of(each)
            if result is not None:
                self.study.tell(each.trial, result)
                del self._open[number]
        self._keep()

    def _keep(self) -> list[TrialResult]:
        results = self.study.results()
        write_results(self.folder.path, results, self.sweep)
        self.on_change(results, len(self._flying))
        return results
