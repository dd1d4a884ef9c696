"""A trial that was drawn and is not told yet: what of it is on disk, and what follows from that."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from jaxleas.sweeps.folder import SweepFolder
from jaxleas.sweeps.job import Outcome, read_outcome
from jaxleas.sweeps.results import TrialResult
from jaxleas.training.config import RunConfig


@dataclass
class OpenTrial:
    """A trial that is not told yet.

    Attributes:
        trial: Optuna's.
        values: of the searched fields.
        configs: of its trainings, by seed.
        folder: of the sweep.
        reported: examinations of the first seed that the storage knows.
        pruned: it was told to stop.
    """

    trial: Any
    values: dict[str, Any]
    configs: dict[int, RunConfig]
    folder: SweepFolder
    reported: int = 0
    pruned: bool = False

    @property
    def number(self) -> int:
        """Counted from 0."""
        return self.trial.number

    def run(self, seed: int) -> Path:
        """Return the run folder of one training."""
        return self.folder.run(self.number, seed)

    def outcomes(self) -> dict[int, Outcome]:
        """Return the outcomes that are there, by seed."""
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
