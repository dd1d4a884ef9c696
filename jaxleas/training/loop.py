"""The training loop: update, log, examine, keep the state, and be ready to stop at any moment."""

from collections.abc import Callable, Collection, Iterator
from contextlib import nullcontext
from dataclasses import dataclass

from jaxleas.configuration import is_own, methods_of
from jaxleas.envs import Task
from jaxleas.runs import (
    POLICY_FILE,
    Background,
    Checkpoints,
    Interruption,
    MetricsLog,
    Progress,
    RunFolder,
    require_watchers,
)
from jaxleas.training.config import RunConfig
from jaxleas.training.devices import Devices, one_device
from jaxleas.training.policy import Policy, read_policy
from jaxleas.training.recorder import Recorder
from jaxleas.training.rehearsal import rehearse
from jaxleas.training.resuming import first_state, mended_best
from jaxleas.training.run_config import make_task
from jaxleas.training.stretches import (
    InterruptedRunError,
    Metrics,
    NonFiniteError,
    Schedule,
    Stretch,
    non_finite,
    stretches,
)
from jaxleas.training.train_state import Learned, TrainState
from jaxleas.training.trainer import Trainer
from jaxleas.types import InputError


def train(
    config: RunConfig,
    run: RunFolder,
    *,
    devices: Devices | None = None,
    learned: Learned | None = None,
    on_examined: Callable[[], None] = lambda: None,
    allow: Collection[str] = (),
) -> Policy:
    """Train to the end, or until interrupted; everything is left in the run folder.

    A folder that holds checkpoints is resumed from the newest, exactly as if the run had never been
    interrupted; on other devices than before, within rounding.

    Args:
        config: configuration of the run.
        run: folder held for writing.
        devices: devices that share the training; by default the first.
        learned: networks to begin with, in place of fresh ones; a resumed run continues its own.
        on_examined: function that is called when an examination's rows are in the run folder and
            its checkpoint is being written; an exception that it raises ends the training, and the
            folder can be resumed.
        allow: user's own code that may be run, as MODULE:CLASS.

    Returns:
        The best policy by held-out success, as in the folder's `policy.npz`.

    Raises:
        NonFiniteError: a number became infinite or NaN.
        InterruptedRunError: a signal asked the run to stop.
        InputError: a watcher is not installed or not set up; or a user's own task does not keep
            the protocol, or raises an exception.
    """
    task = make_task(config, allow)
    rehearse(config, task)
    return train_task(config, task, run, devices or one_device(), learned, on_examined)


def train_task(
    config: RunConfig,
    task: Task,
    run: RunFolder,
    devices: Devices,
    learned: Learned | None = None,
    on_examined: Callable[[], None] = lambda: None,
) -> Policy:
    """Train to the end, or until interrupted, as `train` does, a task that was made before.

    Args:
        config: configuration of the run.
        task: task that is learned; one of the user's own has been rehearsed.
        run: folder held for writing.
        devices: devices that share the training.
        learned: networks to begin with, as for `train`.
        on_examined: function that is called after each examination, as for `train`.
    """
    require_watchers(config.watch)  # before minutes go into compiling
    own = is_own(config.env.task)
    with methods_of(task, f"the task {config.env.task}") if own else nullcontext():
        return _train(Trainer(config, task, devices), run, learned, on_examined)


def _train(
    trainer: Trainer, run: RunFolder, learned: Learned | None, on_examined: Callable[[], None]
) -> Policy:
    config = trainer.config
    checkpoints = Checkpoints(run.checkpoints, config.checkpoints.keep_last)
    resuming = bool(checkpoints.steps())
    step, state, best = first_state(trainer, checkpoints, learned)
    best = mended_best(trainer, run, checkpoints, best)
    total = config.ppo.updates * config.ppo.batch
    with (
        Progress(total, start=step) as progress,
        MetricsLog(
            run.path,
            truncate_after_step=step if resuming else None,
            watch=config.watch,
            config=config.model_dump(mode="json"),
            say=progress.say,
        ) as log,
        Interruption() as interruption,
        Background() as background,
    ):
        recorder = Recorder(trainer, run, checkpoints, log, progress, background, best, on_examined)
        _Session(trainer, interruption, recorder).run(state)
    return read_policy(run.path / POLICY_FILE, of=config.env)


def assist(config: RunConfig, devices: Devices, allow: Collection[str] = ()) -> None:
    """Take part in a training whose run folder process 0 holds: compute, and write nothing.

    Args:
        config: configuration of the run.
        devices: devices of all processes.
        allow: user's own code that may be run, as MODULE:CLASS.

    Raises:
        NonFiniteError: a number became infinite or NaN.
        InterruptedRunError: a signal asked a process to stop.
    """
    trainer = Trainer(config, make_task(config, allow), devices)
    _, state, _ = first_state(trainer, None)
    with Interruption() as interruption:
        _Session(trainer, interruption, None).run(state)


@dataclass
class _Session:
    """One session of a run: from a state to the end, or to an interruption."""

    trainer: Trainer
    interruption: Interruption
    recorder: "Recorder | None"

    def run(self, state: TrainState) -> None:
        self.state = state
        config, done = self.trainer.config, int(state.update)
        schedule = Schedule(config.ppo.updates, config.held_out.every)
        for stretch in stretches(
            self._updates(), schedule, done, lambda: self.interruption.requested
        ):
            done = stretch.done
            self._require_finite(stretch)
            fractions = self._examine() if stretch.due else {}
            kept = self.trainer.gather(self.state)
            if self.recorder is not None:
                self.recorder.record(stretch, fractions)
                self.recorder.save(kept, done, fractions)
        if done < schedule.updates:
            raise InterruptedRunError(self._farewell(done))

    def _updates(self) -> Iterator[Metrics]:
        while True:
            self.state, metrics = self.trainer.train_step(self.trainer.world, self.state)
            yield metrics

    def _farewell(self, done: int) -> str:
        where = "RUN" if self.recorder is None else self.recorder.run.path
        return (
            f"interrupted after {done} of {self.trainer.config.ppo.updates} updates; all is saved:"
            f" resume with  jaxleas train --resume {where}"
        )

    def _require_finite(self, stretch: Stretch) -> None:
        for update, metrics in stretch.rows:
            where = non_finite(metrics)
            if where:
                step = update * self.trainer.config.ppo.batch
                folder = (
                    "process 0's run folder"
                    if self.recorder is None
                    else self.recorder.run.checkpoints
                )
                # The parameters that walked were finite: what was walked is the task's.
                hint = (
                    "the task gave them: look at its advance and look"
                    if {"observation", "reward"} & set(where.split(", "))
                    else "a smaller learning rate or max_gradient_norm may help"
                )
                raise NonFiniteError(
                    f"update {update} (step {step}) made non-finite numbers in: {where}; the last"
                    f" good state is kept in {folder}: {hint}"
                )
            self._require_starts(update, metrics)

    @staticmethod
    def _require_starts(update: int, metrics: Metrics) -> None:
        if metrics["walk/valid_starts"] == 0:
            raise InputError(
                f"update {update}: none of the starts that the task drew is valid, so no episode"
                " can begin: more ppo.candidates may help"
            )

    def _examine(self) -> dict[str, float]:
        state = self.state
        fractions = self.trainer.examine(self.trainer.held_out, state.normaliser, state.averaged)
        return {name: float(value) for name, value in fractions.items()}
