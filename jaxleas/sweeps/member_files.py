"""A member's run folder, written exactly like that of a single training."""

from collections.abc import Collection
from pathlib import Path
from typing import Any

from jaxleas.runs import Checkpoints, MetricsLog
from jaxleas.sweeps.population import Population, member_of
from jaxleas.sweeps.run_folders import hold_run_folder
from jaxleas.training import POLICY_FILE, RunConfig, TrainState, numbers, write_policy

SUCCESS = "held_out/reached"


class MemberFiles:
    """The open run folder of one member.

    Attributes:
        run: run folder, held for writing.
        best: highest held-out success so far; -1 before the first examination.
        failure: reason why the member has failed; empty while it has not.
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
        """Make the run folder, or continue in it.

        Args:
            path: path of the folder.
            config: run configuration of the member.
            command: command line that started the population.
            after_step: when resuming, the step to resume from: later rows are dropped.
            best: highest held-out success so far.
            allow: user's own code that may be run, as MODULE:CLASS.

        Raises:
            InputError: the folder belongs to another run, or is in use.
        """
        self.run = hold_run_folder(path, config, command, allow)
        self.best, self.failure = best, ""
        self._log = MetricsLog(path, truncate_after_step=after_step)

    def record(self, rows: list[tuple[int, dict[str, Any]]], fractions: dict[str, float]) -> None:
        """Append metrics, with the result of the examination in the last row.

        Args:
            rows: step and metrics of each update since the last call.
            fractions: fractions of held-out starts; empty: there was no examination.
        """
        for index, (step, metrics) in enumerate(rows):
            self._log.append(step, numbers(metrics) | (fractions if index == len(rows) - 1 else {}))

    def keep_policy(self, population: Population, states: TrainState, member: int, score: float):
        """Write the policy if it is the best so far; the later of equals, as in a single run."""
        if score >= self.best:
            self.best = score
            write_policy(self.run.path / POLICY_FILE, population.policy(states, member))

    def conclude(self, states: TrainState, member: int, step: int) -> None:
        """Write the final state as an ordinary checkpoint."""
        state = member_of(states, member)
        Checkpoints(self.run.checkpoints).save(step, state, {"best": self.best}, self.best)

    def close(self) -> None:
        """Close the files and let other processes write."""
        self._log.close()
        self.run.close()
