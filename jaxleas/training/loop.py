"""The training loop: update, log, examine, keep the state, and be ready to stop at any moment."""

import logging
from collections.abc import Callable, Collection
from dataclasses import dataclass, field
from typing import Any

import jax
import numpy as np
from jax import Array

from jaxleas.conditions import Condition, Foresight
from jaxleas.envs.steering.env import SteeringEnv
from jaxleas.envs.steering.world import World
from jaxleas.runs.background import Background
from jaxleas.runs.checkpoints import Checkpoints, NoCheckpointError
from jaxleas.runs.folder import RunFolder
from jaxleas.runs.interruption import Interruption
from jaxleas.runs.metrics import MetricsLog
from jaxleas.runs.progress import Progress
from jaxleas.runs.watching import require_watchers
from jaxleas.training.config import RunConfig
from jaxleas.training.devices import Devices, one_device
from jaxleas.training.held_out import make_examination
from jaxleas.training.networks import make_networks
from jaxleas.training.policy import SteeringPolicy, policy_of, read_policy, write_policy
from jaxleas.training.ppo import make_train_step
from jaxleas.training.processes import any_process, from_first
from jaxleas.training.train_state import Learned, TrainState, initial_state
from jaxleas.training.worlds import held_out_world, training_world
from jaxleas.types import InputError, JaxleasError

POLICY_FILE = "policy.npz"
# Updates that the devices have before them: cores that share a program hang in XLA:CPU with more
# than some thirty of its runs to come.
MOST_AHEAD = 8
_LOG = logging.getLogger("jaxleas")


class NonFiniteError(JaxleasError):
    """A number became infinite or NaN; the run stops, the last good state is kept."""


class InterruptedRunError(JaxleasError):
    """The run was asked to stop and has saved everything done so far."""

    exit_code = 130  # what a shell reports for Ctrl-C


@dataclass
class Trainer:
    """The compiled pieces of one run.

    Attributes:
        config: of the run.
        condition: that ends episodes; by default the environment's own, R* and C.
        devices: that share the training; by default the first.
        foresight: that ends episodes, too, such as a surrogate of a contact planner.
        allow: each MODULE:CLASS of the configuration that a person has named.
        env: the task.
        world: terrains to train on.
        held_out: terrains of the examination.
        train_step: jitted; donates the state it is given.
        examine: jitted.
        fresh_state: makes the state before the first update.
    """

    config: RunConfig
    condition: Condition | None = None
    devices: Devices = field(default_factory=one_device)
    foresight: Foresight | None = None
    allow: Collection[str] = ()
    env: SteeringEnv = field(init=False)
    world: World = field(init=False)
    held_out: World = field(init=False)
    train_step: Callable[[World, TrainState], tuple[TrainState, dict[str, Array]]] = field(
        init=False
    )
    examine: Callable[[World, Any, Any], dict[str, Array]] = field(init=False)
    fresh_state: Callable[[], TrainState] = field(init=False)

    def __post_init__(self) -> None:
        config, devices = self.config, self.devices
        self.env = SteeringEnv(config.env, self.condition, self.foresight, self.allow)
        self.world = jax.device_put(training_world(config), devices.whole)
        self.held_out = jax.device_put(held_out_world(config), devices.whole)
        networks = make_networks(config.network, self.env)
        self.train_step = jax.jit(
            make_train_step(config, self.env, devices),
            donate_argnums=1,
            in_shardings=(devices.whole, devices.state),
            out_shardings=(devices.state, devices.whole),
        )
        self.examine = jax.jit(
            make_examination(config, self.env, networks, devices.divide),
            out_shardings=devices.whole,
        )
        begin = jax.jit(
            lambda world: initial_state(config, self.env, world, networks),
            out_shardings=devices.state,
        )
        self.fresh_state = lambda: begin(self.world)

    def policy(self, state: TrainState) -> SteeringPolicy:
        """Return the policy that is judged and exported: the averaged actor."""
        return policy_of(self.env, self.config.network.activation, state.normaliser, state.averaged)


def train(
    config: RunConfig,
    run: RunFolder,
    condition: Condition | None = None,
    devices: Devices | None = None,
    foresight: Foresight | None = None,
    learned: Learned | None = None,
    on_examined: Callable[[], None] = lambda: None,
    allow: Collection[str] = (),
) -> SteeringPolicy:
    """Train to the end, or until interrupted; everything is left in the run folder.

    A folder that holds checkpoints is gone on with from the newest, exactly as if the run had
    never been interrupted; on other devices than before, within rounding.

    Args:
        config: of the run.
        run: folder held for writing.
        condition: that ends episodes, in place of R* and C.
        devices: that share the training; by default the first.
        foresight: that ends episodes, too, such as a surrogate of a contact planner.
        learned: to begin with, in place of fresh networks; a resumed run has its own.
        on_examined: called when an examination's rows are in the run folder, its checkpoint on its
            way; what it raises ends the training, and the folder can be gone on with.
        allow: each MODULE:CLASS of the configuration's conditions that a person has named.

    Returns:
        The best policy by held-out success, as in the folder's `policy.npz`.

    Raises:
        NonFiniteError: a number became infinite or NaN.
        InterruptedRunError: a signal asked the run to stop.
        InputError: a watcher is not installed or not set up.
    """
    require_watchers(config.watch)  # before minutes go into compiling
    trainer = Trainer(config, condition, devices or one_device(), foresight, allow)
    checkpoints = Checkpoints(run.checkpoints, config.checkpoints.keep_last)
    resuming = bool(checkpoints.steps())
    step, state, best = _first_state(trainer, checkpoints, learned)
    best = _mended_best(trainer, run, checkpoints, best)
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
        desk = _Desk(trainer, run, checkpoints, log, progress, background, best, on_examined)
        _Session(trainer, interruption, desk).go_on(state)
    return read_policy(run.path / POLICY_FILE)


def assist(
    config: RunConfig,
    devices: Devices,
    condition: Condition | None = None,
    allow: Collection[str] = (),
) -> None:
    """Take part in a training whose run folder process 0 holds: compute, and write nothing.

    Args:
        config: of the run.
        devices: of all processes.
        condition: that ends episodes, in place of R* and C.
        allow: each MODULE:CLASS of the configuration's conditions that a person has named.

    Raises:
        NonFiniteError: a number became infinite or NaN.
        InterruptedRunError: a signal asked a process to stop.
    """
    trainer = Trainer(config, condition, devices, allow=allow)
    _, state, _ = _first_state(trainer, None)
    with Interruption() as interruption:
        _Session(trainer, interruption, None).go_on(state)


def _first_state(
    trainer: Trainer, checkpoints: Checkpoints | None, learned: Learned | None = None
) -> tuple[int, TrainState, float]:
    """Return step, state and best score to go on from: the newest checkpoint's, or fresh ones.

    Only process 0 has checkpoints; the other processes get its state.
    """
    like = jax.eval_shape(trainer.fresh_state)
    found = None

    def look() -> str:
        nonlocal found
        if checkpoints is not None and checkpoints.steps():
            found = _latest(checkpoints, like)
        return "fresh" if found is None else "resumed"

    if from_first(look) == "resumed":
        step, state, note = found or (0, like, {"best": -1.0})
        return step, trainer.devices.place(state), note["best"]
    state = trainer.fresh_state()
    if learned is not None:
        state = trainer.devices.place(learned.into(state))
    kept = trainer.devices.gather(state)
    if checkpoints is not None:
        checkpoints.save(0, kept, {"best": -1.0})
    return 0, state, -1.0


def _latest(checkpoints: Checkpoints, like: TrainState) -> tuple[int, TrainState, dict] | None:
    """Return the newest state, or None where nothing but the very first was there and is lost."""
    try:
        return checkpoints.latest(like)
    except NoCheckpointError as error:
        if checkpoints.steps() != [0]:
            raise
        _LOG.warning("%s: no step had been done yet, so training begins anew", error)
        return None


def _mended_best(trainer: Trainer, run: RunFolder, checkpoints: Checkpoints, best: float) -> float:
    """Make `policy.npz` again from the best checkpoint where it was damaged; return its score."""
    if best < 0.0:
        return best  # none was written yet
    try:
        read_policy(run.path / POLICY_FILE)
    except InputError as damage:
        try:
            step, state, _ = checkpoints.best(jax.eval_shape(trainer.fresh_state))
        except InputError as error:
            _LOG.warning("%s; %s: the best policy from here on is kept", damage, error)
            return -1.0
        write_policy(run.path / POLICY_FILE, trainer.policy(state))
        _LOG.warning("%s; it is made again from the checkpoint of step %d", damage, step)
    return best


@dataclass
class _Session:
    """One sitting of a run: from a state to the end, or to an interruption."""

    trainer: Trainer
    interruption: Interruption
    desk: "_Desk | None"

    def go_on(self, state: TrainState) -> None:
        config = self.trainer.config
        alone = jax.process_count() == 1
        done = int(state.update)
        pending: list[tuple[int, dict[str, Array]]] = []
        while done < config.ppo.updates:
            state, metrics = self.trainer.train_step(self.trainer.world, state)
            done += 1
            pending.append((done, metrics))
            if len(pending) >= MOST_AHEAD:
                jax.block_until_ready(pending[-MOST_AHEAD][1])
            due = done % config.held_out.every == 0 or done == config.ppo.updates
            # Several processes decide together, where they wait for each other anyway.
            if due or (alone and self.interruption.requested):
                # The only point where the host waits for the newest update.
                rows = self._check(pending)
                pending = []
                verdict = self._examine(state) if due else {}
                kept = self.trainer.devices.gather(state)
                if self.desk is not None:
                    self.desk.record(rows, verdict)
                    self.desk.save(kept, done, verdict)
                if any_process(self.interruption.requested) and done < config.ppo.updates:
                    raise InterruptedRunError(self._farewell(done))

    def _farewell(self, done: int) -> str:
        where = "RUN" if self.desk is None else self.desk.run.path
        return (
            f"interrupted after {done} of {self.trainer.config.ppo.updates} updates; all is saved:"
            f" go on with  python train.py --resume {where}"
        )

    def _check(self, pending: list[tuple[int, dict[str, Array]]]) -> list[tuple[int, dict]]:
        """Fetch the metrics of the updates since the last check; stop at a non-finite number."""
        rows = jax.device_get(pending)
        for update, metrics in rows:
            bad = [name for name, fine in metrics.items() if "finite/" in name and not fine]
            if bad:
                where = ", ".join(name.removeprefix("finite/") for name in bad)
                step = update * self.trainer.config.ppo.batch
                folder = (
                    "process 0's run folder" if self.desk is None else self.desk.run.checkpoints
                )
                raise NonFiniteError(
                    f"update {update} (step {step}) made non-finite numbers in: {where}; the last"
                    f" good state is kept in {folder}: a smaller learning rate or"
                    " max_gradient_norm may help"
                )
        return rows

    def _examine(self, state: TrainState) -> dict[str, float]:
        verdict = self.trainer.examine(self.trainer.held_out, state.normaliser, state.averaged)
        return {name: float(value) for name, value in verdict.items()}


@dataclass
class _Desk:
    """Where process 0 writes down what all have computed."""

    trainer: Trainer
    run: RunFolder
    checkpoints: Checkpoints
    log: MetricsLog
    progress: Progress
    background: Background
    best: float
    on_examined: Callable[[], None]

    def record(self, rows: list[tuple[int, dict]], verdict: dict[str, float]) -> None:
        batch = self.trainer.config.ppo.batch
        for update, metrics in rows:
            numbers = {
                name: float(value) for name, value in metrics.items() if "finite/" not in name
            }
            last = update == rows[-1][0]
            self.log.append(update * batch, numbers | (verdict if last else {}))
        shown = {"return": f"{float(rows[-1][1]['walk/reward']):.3f} a step"}
        if verdict:
            shown["held out"] = f"{100 * verdict['held_out/reached']:.1f} %"
        self.progress.update(rows[-1][0] * batch, shown)

    def save(self, state: TrainState, done: int, verdict: dict[str, float]) -> None:
        """Have the state written, and the policy if it is the best; the training need not wait."""
        score = verdict.get("held_out/reached")
        policy = None
        # Of equals the later: its learning rate was smaller and its average longer.
        if score is not None and score >= self.best:
            self.best = score
            policy = jax.tree.map(np.array, self.trainer.policy(state))
        step = done * self.trainer.config.ppo.batch
        packed = self.checkpoints.packed(step, state, {"best": self.best}, best_score=score)

        def write() -> None:
            if policy is not None:
                write_policy(self.run.path / POLICY_FILE, policy)
            # Rows first, so that no power cut leaves a checkpoint without them.
            self.log.sync()
            self.checkpoints.write(packed)

        self.background.submit(write)
        if verdict:
            self.on_examined()
