"""A member's run folder, written as that of a training alone: nobody can tell them apart."""

from collections.abc import Collection
from pathlib import Path
from typing import Any

from jaxleas.runs.checkpoints import Checkpoints
from jaxleas.runs.metrics import MetricsLog
from jaxleas.sweeps.population import Population, member_of
from jaxleas.sweeps.run_folders import hold_run_folder
from jaxleas.training.config import RunConfig
from jaxleas.training.policy import write_policy
from jaxleas.training.train_state import TrainState

POLICY_FILE = "policy.npz"
SUCCESS = "held_out/reached"


class MemberFiles:
    """The open run folder of one member.

    Attributes:
        run: its folder, held for writing.
        best: highest held-out success so far; -1 before the first examination.
        failure: why the member is given up; empty while it is not.
    """

    def __init__(
        self,
        path: Path,
        config: RunConfig,
        command: list[str],
        after_step: int | None,
        best: float,
        allow: Collection[str] = (),
    ) -> None:
        """Make the run folder, or go on in it.

        Args:
            path: of the folder.
            config: of the member.
            command: that started the population.
            after_step: when resuming, the step resumed from: later rows are dropped.
            best: highest held-out success so far.
            allow: code of the user's own that may be run, each MODULE:CLASS.

        Raises:
            InputError: the folder is another run's, or in use.
        """
        self.run = hold_run_folder(path, config, command, allow)
        self.best, self.failure = best, ""
        self._log = MetricsLog(path, truncate_after_step=after_step)

    def record(self, rows: list[tuple[int, dict[str, Any]]], verdict: dict[str, float]) -> None:
        """Append metrics, the last of them with the verdict of the examination.

        Args:
            rows: (step, metrics) of each update since the last time.
            verdict: fractions of held-out starts; empty: no examination was held.
        """
        for index, (step, metrics) in enumerate(rows):
            numbers = {name: float(each) for name, each in metrics.items() if "finite/" not in name}
            self._log.append(step, numbers | (verdict if index == len(rows) - 1 else {}))

    def keep_policy(self, population: Population, states: TrainState, member: int, score: float):
        """Write the policy if it is the best so far; of equals the later, as in a run alone."""
        if score >= self.best:
            self.best = score
            write_policy(self.run.path / POLICY_FILE, population.policy(states, member))

    def conclude(self, states: TrainState, member: int, step: int) -> None:
        """Leave the final state as an ordinary checkpoint."""
        state = member_of(states, member)
        Checkpoints(self.run.checkpoints).save(step, state, {"best": self.best}, self.best)

    def close(self) -> None:
        """Close the files and let others write."""
        self._log.close()
        self.run.close()
