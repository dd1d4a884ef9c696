"""A round's practice in faithful mode, in its run folder: progress, checkpoints, interruption."""

import time
from collections.abc import Callable, Generator
from contextlib import closing
from dataclasses import dataclass

import jax

from jaxleas.configuration import to_yaml
from jaxleas.distillation.faithful import Faithful
from jaxleas.distillation.folder import RoundFolder
from jaxleas.distillation.practice import conclude
from jaxleas.runs import Checkpoints, Interruption, MetricsLog, Progress, RunFolder
from jaxleas.training import (
    POLICY_FILE,
    InterruptedRunError,
    Learned,
    Metrics,
    NonFiniteError,
    Schedule,
    Stretch,
    TrainState,
    held_out_world,
    make_examination,
    non_finite,
    numbers,
    policy_of,
    stretches,
    write_policy,
)


def practise_faithfully(folder: RoundFolder, training: Faithful, learned: Learned) -> None:
    """Train with the exact planner in the loop, and resume an interrupted practice.

    The kept policy is the averaged one after the last update, not a chosen one.

    Args:
        folder: folder of the round.
        training: training to run in the folder.
        learned: networks to begin with.

    Raises:
        InterruptedRunError: a signal asked the practice to stop; all that was learned is saved.
        NonFiniteError: a number became infinite or NaN.
    """
    begun, config = time.perf_counter(), training.config
    if (folder.run / "config.yaml").is_file():
        run = RunFolder.open(folder.run, writing=True, needs_checkpoint=False)
    else:
        run = RunFolder.create(folder.run, to_yaml(config), ["jaxleas", "distill"])
    with run:
        _practise(training, run, learned, str(folder.path.parent))
    conclude(folder, config, time.perf_counter() - begun)


def _practise(training: Faithful, run: RunFolder, learned: Learned, out: str) -> None:
    config = training.config
    checkpoints = Checkpoints(run.checkpoints, config.checkpoints.keep_last)
    fresh = training.fresh_state(learned)
    step, state = 0, fresh
    resuming = bool(checkpoints.steps())
    if resuming:
        step, state, _ = checkpoints.latest(jax.eval_shape(lambda: fresh))
    with (
        MetricsLog(run.path, truncate_after_step=step if resuming else None) as log,
        Progress(config.ppo.updates * config.ppo.batch, start=step) as progress,
        Interruption() as interruption,
    ):
        session = _Session(training, run, checkpoints, log, progress, state)
        if not resuming:
            session.save()
        done = session.work(lambda: interruption.requested)
    if done < config.ppo.updates:
        raise InterruptedRunError(
            f"interrupted after {done} of {config.ppo.updates} updates; what was learned is saved:"
            f" the same command resumes in {out}"
        )


@dataclass
class _Session:
    """Drives the updates, and records each of them."""

    training: Faithful
    run: RunFolder
    checkpoints: Checkpoints
    log: MetricsLog
    progress: Progress
    state: TrainState

    def __post_init__(self) -> None:
        config = self.training.config
        task = self.training.task
        self.held_out = held_out_world(config, task)
        self.examine = jax.jit(make_examination(config, task, self.training.networks))

    def work(self, asked_to_stop: Callable[[], bool]) -> int:
        """Do the updates, or those that there is time for; return how many are done in all."""
        config, done = self.training.config, int(self.state.update)
        schedule = Schedule(config.ppo.updates, config.held_out.every, one_by_one=True)
        with closing(self._updates(asked_to_stop)) as updates:
            for stretch in stretches(updates, schedule, done, asked_to_stop):
                self._record(stretch)
                done = stretch.done
                if stretch.due:
                    self.save()
        if done < schedule.updates:
            self.save()
        return done

    def _updates(self, asked_to_stop: Callable[[], bool]) -> Generator[Metrics, None, None]:
        updates = self.training.updates(self.state, asked_to_stop, self.show)
        with closing(updates):
            for self.state, metrics in updates:
                yield metrics

    def _record(self, stretch: Stretch) -> None:
        """Log each update, with the examination in the last row."""
        examined: dict[str, float] = {}
        for update, metrics in stretch.rows:
            where = non_finite(metrics)
            if where:
                raise NonFiniteError(
                    f"update {update} made non-finite numbers in: {where}; the last good state is"
                    f" kept in {self.run.checkpoints}: a smaller practice.learning_rate may help"
                )
            if stretch.due and update == stretch.done:
                found = self.examine(self.held_out, self.state.normaliser, self.state.averaged)
                examined = {name: float(value) for name, value in found.items()}
            self.log.append(update * self.training.config.ppo.batch, numbers(metrics) | examined)

    def show(self, state: TrainState, waiting: int) -> None:
        """Show the progress by wave: updates come in bursts, waves at an even pace."""
        shown = {"planned": f"{100 * self.training.tally.share:.1f} %"}
        step = int(state.update) * self.training.config.ppo.batch + waiting
        self.progress.update(min(step, self.progress.total), shown)

    def save(self) -> None:
        """Save the state and policy."""
        config, state = self.training.config, self.state
        policy = policy_of(self.training.networks, config.env, state.normaliser, state.averaged)
        write_policy(self.run.path / POLICY_FILE, policy)
        self.checkpoints.save(int(state.update) * config.ppo.batch, state, {})
