"""What a faithful training logs besides PPO's own numbers: guides, verdicts, staleness."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from jaxleas.distillation.cutting import kept_steps
from jaxleas.distillation.episodes import Episodes
from jaxleas.types import Verdict


@dataclass
class Tally:
    """Counts of the waves since the last update."""

    guides: int = 0
    passed: int = 0
    undecided: int = 0
    walked: int = 0
    kept: int = 0
    seconds: float = 0.0

    def count(self, episodes: Episodes, verdicts: Sequence[Verdict]) -> None:
        """Count a judged wave."""
        self.guides += len(verdicts)
        self.passed += sum(verdict.success for verdict in verdicts)
        self.undecided += sum(not verdict.decided for verdict in verdicts)
        self.walked += int(episodes.steps.sum())
        self.kept += int(kept_steps(episodes, verdicts).sum())
        self.seconds += sum(verdict.seconds for verdict in verdicts)

    @property
    def share(self) -> float:
        """Return the share of the guide paths that the planner succeeded on."""
        return self.passed / max(self.guides, 1)

    def take(self) -> dict[str, float]:
        """Return the numbers as metrics, and reset; empty where no wave came in between."""
        found = {}
        if self.guides:
            found = {
                "planner/guides": float(self.guides),
                "planner/passed": self.share,
                "planner/undecided": self.undecided / self.guides,
                "planner/steps_walked": float(self.walked),
                "planner/steps_kept": self.kept / max(self.walked, 1),
                "planner/seconds_a_guide": self.seconds / self.guides,
            }
        self.__init__()
        return found


def batch_metrics(batch: dict[str, np.ndarray], update: int) -> dict[str, float]:
    """Return metrics of the walks in a batch, under the names of the ordinary training.

    Args:
        batch: batch to be learned from, and one step more.
        update: number of updates done before the batch.
    """
    size = len(batch["reward"]) - 1

    def per_1000(name: str) -> float:
        return 1000.0 * float(batch[name][:size].sum()) / size

    age = update - batch["update"][:size]
    return {
        "walk/reward": float(batch["reward"][:size].mean()),
        "walk/failures_per_1000_steps": per_1000("terminated"),
        "walk/goals_per_1000_steps": per_1000("reached"),
        "walk/episodes": float(batch["terminated"][:size].sum() + batch["truncated"][:size].sum()),
        "planner/failures_per_1000_steps": per_1000("by_planner"),
        "planner/staleness_mean": float(age.mean()),
        "planner/staleness_most": float(age.max()),
    }
