"""A round's practice in faithful mode, in its run folder: progress, checkpoints, interruption."""

import time
from dataclasses import dataclass
from typing import Any

import jax

from jaxleas.configuration.loading import to_yaml
from jaxleas.distillation.faithful import Faithful
from jaxleas.distillation.folder import RoundFolder
from jaxleas.distillation.practice import conclude
from jaxleas.envs.steering.task import Steering
from jaxleas.runs.checkpoints import Checkpoints
from jaxleas.runs.folder import RunFolder
from jaxleas.runs.interruption import Interruption
from jaxleas.runs.metrics import MetricsLog
from jaxleas.runs.progress import Progress
from jaxleas.training.examination import make_examination
from jaxleas.training.loop import POLICY_FILE, InterruptedRunError, NonFiniteError
from jaxleas.training.policy import policy_of, write_policy
from jaxleas.training.train_state import Learned, TrainState
from jaxleas.training.worlds import held_out_world


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
        _sit(training, run, learned, str(folder.path.parent))
    conclude(folder, config, time.perf_counter() - begun)


def _sit(training: Faithful, run: RunFolder, learned: Learned, out: str) -> None:
    config = training.config
    checkpoints = Checkpoints(run.checkpoints, config.checkpoints.keep_last)
    fresh = training.fresh_state(learned)
    step, state = 0, fresh
    resuming = bool(checkpoints.steps())
    if resuming:
        step, state, _ = checkpoints.latest(jax.eval_shape(lambda: fresh))
    if int(state.update) >= config.ppo.updates:
        return
    with (
        MetricsLog(run.path, truncate_after_step=step if resuming else None) as log,
        Progress(config.ppo.updates * config.ppo.batch, start=step) as progress,
        Interruption() as interruption,
    ):
        desk = _Desk(training, run, checkpoints, log, progress)
        if not resuming:
            desk.save(state)
        state = training.run(state, desk.record, lambda: interruption.requested, desk.show)
        if int(state.update) < config.ppo.updates:
            desk.save(state)
            raise InterruptedRunError(
                f"interrupted after {int(state.update)} of {config.ppo.updates} updates; what was"
                f" learned is saved: the same command goes on in {out}"
            )


@dataclass
class _Desk:
    """Records each update."""

    training: Faithful
    run: RunFolder
    checkpoints: Checkpoints
    log: MetricsLog
    progress: Progress

    def __post_init__(self) -> None:
        config = self.training.config
        task = Steering(config.env, config.terrain)
        self.held_out = held_out_world(config, task)
        self.examine = jax.jit(make_examination(config, task, self.training.networks))

    def record(self, state: TrainState, metrics: dict[str, Any]) -> None:
        """Log an update; evaluate and save at intervals."""
        config, done = self.training.config, int(state.update)
        bad = [name for name, fine in metrics.items() if "finite/" in name and not fine]
        if bad:
            where = ", ".join(name.removeprefix("finite/") for name in bad)
            raise NonFiniteError(
                f"update {done} made non-finite numbers in: {where}; the last good state is kept in"
                f" {self.run.checkpoints}: a smaller practice.learning_rate may help"
            )
        numbers = {name: float(each) for name, each in metrics.items() if "finite/" not in name}
        due = done % config.held_out.every == 0 or done >= config.ppo.updates
        if due:
            verdict = self.examine(self.held_out, state.normaliser, state.averaged)
            numbers |= {name: float(value) for name, value in verdict.items()}
        self.log.append(done * config.ppo.batch, numbers)
        if due:
            self.save(state)

    def show(self, state: TrainState, waiting: int) -> None:
        """Show the progress by wave: updates come in bursts, waves at an even pace."""
        shown = {"planned": f"{100 * self.training.tally.share:.1f} %"}
        step = int(state.update) * self.training.config.ppo.batch + waiting
        self.progress.update(min(step, self.progress.total), shown)

    def save(self, state: TrainState) -> None:
        """Save the state and policy."""
        config = self.training.config
        policy = policy_of(self.training.networks, config.env, state.normaliser, state.averaged)
        write_policy(self.run.path / POLICY_FILE, policy)
        self.checkpoints.save(int(state.update) * config.ppo.batch, state, {})
