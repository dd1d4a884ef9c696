"""A trial that was drawn and not reported yet: its files on disk, and its result from them."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from jaxleas.sweeps.folder import SweepFolder
from jaxleas.sweeps.job_files import Outcome, read_outcome
from jaxleas.sweeps.results import TrialResult
from jaxleas.training import RunConfig


@dataclass
class OpenTrial:
    """A trial whose result is not reported yet.

    Attributes:
        trial: Optuna trial.
        values: values of the searched fields.
        configs: run configurations of its trainings, by seed.
        folder: folder of the sweep.
        reported: number of examinations of the first seed that were reported to the storage.
        pruned: whether the trial was asked to stop.
    """

    trial: Any
    values: dict[str, Any]
    configs: dict[int, RunConfig]
    folder: SweepFolder
    reported: int = 0
    pruned: bool = False

    @property
    def number(self) -> int:
        """Number of the trial, counted from 0."""
        return self.trial.number

    def run(self, seed: int) -> Path:
        """Return the run folder of one training."""
        return self.folder.run(self.number, seed)

    def outcomes(self) -> dict[int, Outcome]:
        """Return the existing outcomes, by seed."""
        found = {seed: read_outcome(self.run(seed)) for seed in self.configs}
        return {seed: outcome for seed, outcome in found.items() if outcome is not None}


def result_of(each: OpenTrial) -> TrialResult | None:
    """Return a trial's result, or None while it is not decided."""
    outcomes = each.outcomes()
    seconds = round(sum(outcome.seconds for outcome in outcomes.values()), 1)
    bad = next((outcome for outcome in outcomes.values() if outcome.state != "done"), None)
    seeds = {str(seed): outcome.values for seed, outcome in outcomes.items()}
    if bad is not None:
        return TrialResult(each.number, bad.state, each.values, {}, seeds, bad.reason, seconds)
    if len(outcomes) < len(each.configs):
        return None
    names = next(iter(outcomes.values())).values
    means = {
        name: sum(outcome.values[name] for outcome in outcomes.values()) / len(outcomes)
        for name in names
    }
    return TrialResult(each.number, "done", each.values, means, seeds, "", seconds)
