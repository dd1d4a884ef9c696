"""The loop of a population: update, examine, evolve, keep everything, be ready to stop."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import jax
import numpy as np

from jaxleas.runs import Checkpoints, Interruption, Progress
from jaxleas.sweeps.evolution import Values, evolve
from jaxleas.sweeps.history import History
from jaxleas.sweeps.member_files import SUCCESS, MemberFiles
from jaxleas.sweeps.population import Population
from jaxleas.sweeps.population_config import Members
from jaxleas.sweeps.takeover import taken_over
from jaxleas.training import (
    InterruptedRunError,
    Metrics,
    PpoParams,
    Schedule,
    Stretch,
    TrainState,
    non_finite,
    stretches,
)


@dataclass(frozen=True)
class MemberResult:
    """The result of one member.

    Attributes:
        run: run folder of the member.
        best: highest held-out success.
        failure: reason why it failed; empty if it did not.
        values: values of the varied fields at the end.
    """

    run: Path
    best: float
    failure: str
    values: Values


def train_population(
    members: Members, runs: Sequence[Path], home: Path, command: Sequence[str] = ()
) -> list[MemberResult]:
    """Train a population to the end, or until interrupted.

    A home that holds checkpoints is resumed from the newest, exactly as if the population had never
    been interrupted.

    Args:
        members: members to train.
        runs: run folder of each member.
        home: folder of the population's checkpoints and history.
        command: command line that started it, for the run folders' provenance.

    Raises:
        InputError: a folder belongs to another run, or is in use.
        InterruptedRunError: a signal asked to stop; everything done is saved.
    """
    loop = _Loop(members, runs, home, list(command))
    try:
        return loop.run()
    finally:
        loop.close()


class _Loop:
    def __init__(
        self, members: Members, runs: Sequence[Path], home: Path, command: list[str]
    ) -> None:
        self.members, self.home = members, home
        self.config = members.configs[0]
        self.population = Population(members.configs, members.allow)
        self.checkpoints = Checkpoints(home / "checkpoints", self.config.checkpoints.keep_last)
        resuming = bool(self.checkpoints.steps())
        step, self.states, note = self._first_states(resuming)
        self.values: list[Values] = note["values"]
        self._set_params()
        self.history = History(home / "history.jsonl", step)
        self.files: list[MemberFiles] = []
        try:
            for number, (path, config) in enumerate(zip(runs, members.configs, strict=True)):
                after, best = step if resuming else None, note["best"][number]
                self.files.append(MemberFiles(path, config, command, after, best, members.allow))
                self.files[-1].failure = note["failures"][number]
        except BaseException:
            self.close()
            raise
        self.done = step // self.config.ppo.batch

    def _first_states(self, resuming: bool) -> tuple[int, TrainState, dict[str, Any]]:
        if resuming:
            like = jax.eval_shape(self.population.fresh_states)
            step, states, note = self.checkpoints.latest(like)
            return step, self.population.place(states), note
        count = len(self.members.configs)
        values = [dict(each) for each in self.members.values]
        note = {"values": values, "best": [-1.0] * count, "failures": [""] * count}
        return 0, self.population.fresh_states(), note

    def _set_params(self) -> None:
        configs = self.members.with_values(self.values)
        self.params = self.population.place(PpoParams.stack(configs))

    def run(self) -> list[MemberResult]:
        ppo, robots = self.config.ppo, len(self.files) * self.config.ppo.batch
        schedule = Schedule(ppo.updates, self.config.held_out.every)
        with (
            Progress(ppo.updates * robots, start=self.done * robots) as progress,
            Interruption() as interruption,
        ):
            for stretch in stretches(
                self._updates(), schedule, self.done, lambda: interruption.requested
            ):
                self.done = stretch.done
                scores = self._record(stretch)
                if stretch.due and self.done < ppo.updates:
                    self._evolve(scores)
                self._save()
                progress.update(self.done * robots, self._shown(scores))
            if self.done < ppo.updates:
                raise InterruptedRunError(
                    f"interrupted after {self.done} of {ppo.updates} updates; all is saved:"
                    " the same command resumes"
                )
        for number, files in enumerate(self.files):
            if not files.failure:
                files.conclude(self.states, number, self.done * ppo.batch)
        return [
            MemberResult(files.run.path, files.best, files.failure, values)
            for files, values in zip(self.files, self.values, strict=True)
        ]

    def _updates(self) -> Iterator[Metrics]:
        while True:
            self.states, metrics = self.population.train_step(
                self.population.world, self.states, self.params
            )
            yield metrics

    def _record(self, stretch: Stretch) -> list[float]:
        """Write the members' metrics; return their held-out success, NaN for those that failed."""
        examined: dict[str, np.ndarray] = {}
        if stretch.due:
            states = self.states
            found = self.population.examine(
                self.population.held_out, states.normaliser, states.averaged
            )
            examined = jax.device_get(found)
        scores = []
        for number, files in enumerate(self.files):
            own = [
                (update * self.config.ppo.batch, {name: each[number] for name, each in row.items()})
                for update, row in stretch.rows
            ]
            files.failure = files.failure or _failure(own)
            scores.append(float("nan"))
            if files.failure:
                continue
            fractions = {name: float(each[number]) for name, each in examined.items()}
            files.record(own, fractions)
            if stretch.due:
                scores[-1] = fractions[SUCCESS]
                files.keep_policy(self.population, self.states, number, scores[-1])
        return scores

    def _evolve(self, scores: list[float]) -> None:
        evolution = self.members.evolution
        examination = self.done // self.config.held_out.every
        if evolution is None or examination % evolution.every:
            return
        # A separate stream for every round: it is the same after a resume.
        stream = np.random.default_rng((self.members.seed, len(self.files), examination))
        round_ = evolve(evolution, self.members.space, scores, self.values, stream)
        parents = np.array([each.parent for each in round_])
        failed = np.array([bool(files.failure) for files in self.files])
        self.states = self.population.place(taken_over(self.states, parents, failed))
        self.values = [each.values for each in round_]
        self._set_params()
        # A failed member continues as a copy of another.
        failures = [self.files[each.parent].failure for each in round_]
        for files, failure in zip(self.files, failures, strict=True):
            files.failure = failure
        self.history.append(self.done * self.config.ppo.batch, scores, round_)

    def _save(self) -> None:
        note = {
            "values": self.values,
            "best": [files.best for files in self.files],
            "failures": [files.failure for files in self.files],
        }
        self.checkpoints.save(self.done * self.config.ppo.batch, self.states, note)

    def _shown(self, scores: list[float]) -> dict[str, str]:
        alive = [each for each in scores if np.isfinite(each)]
        if not alive:
            return {}
        return {"held out": f"{100 * min(alive):.1f} to {100 * max(alive):.1f} %"}

    def close(self) -> None:
        for files in self.files:
            files.close()


def _failure(rows: list[tuple[int, dict[str, Any]]]) -> str:
    """Return which numbers of a member became infinite or NaN first, or nothing."""
    for step, metrics in rows:
        where = non_finite(metrics)
        if where:
            return f"non-finite numbers at step {step} in: {where}"
    return ""
