"""The training loop: update, log, examine, keep the state, and be ready to stop at any moment."""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import jax
from jax import Array

from jaxleas.conditions import Condition, Foresight
from jaxleas.envs.steering.env import SteeringEnv
from jaxleas.envs.steering.world import World
from jaxleas.training.checkpoints import Checkpoints
from jaxleas.training.config import RunConfig
from jaxleas.training.held_out import make_examination
from jaxleas.training.interruption import Interruption
from jaxleas.training.metrics import MetricsLog
from jaxleas.training.networks import make_networks
from jaxleas.training.policy import SteeringPolicy, policy_of, read_policy, write_policy
from jaxleas.training.ppo import make_train_step
from jaxleas.training.progress import Progress
from jaxleas.training.run_folder import RunFolder
from jaxleas.training.train_state import TrainState, initial_state
from jaxleas.training.worlds import held_out_world, training_world
from jaxleas.types import JaxleasError

POLICY_FILE = "policy.npz"


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
        foresight: that ends episodes, too, such as a surrogate of a contact planner.
        env: the task.
        world: terrains to train on.
        held_out: terrains of the examination.
        train_step: jitted; donates the state it is given.
        examine: jitted.
        fresh_state: makes the state before the first update.
    """

    config: RunConfig
    condition: Condition | None = None
    foresight: Foresight | None = None
    env: SteeringEnv = field(init=False)
    world: World = field(init=False)
    held_out: World = field(init=False)
    train_step: Callable[[World, TrainState], tuple[TrainState, dict[str, Array]]] = field(
        init=False
    )
    examine: Callable[[World, Any, Any], dict[str, Array]] = field(init=False)
    fresh_state: Callable[[], TrainState] = field(init=False)

    def __post_init__(self) -> None:
        config = self.config
        self.env = SteeringEnv(config.env, self.condition, self.foresight)
        self.world = training_world(config)
        self.held_out = held_out_world(config)
        networks = make_networks(config.network, self.env)
        self.train_step = jax.jit(make_train_step(config, self.env, networks), donate_argnums=1)
        self.examine = jax.jit(make_examination(config, self.env, networks))
        begin = jax.jit(lambda world: initial_state(config, self.env, world, networks))
        self.fresh_state = lambda: begin(self.world)

    def policy(self, state: TrainState) -> SteeringPolicy:
        """Return the policy that is judged and exported: the averaged actor."""
        return policy_of(self.env, self.config.network.activation, state.normaliser, state.averaged)


def train(config: RunConfig, run: RunFolder, condition: Condition | None = None) -> SteeringPolicy:
    """Train to the end, or until interrupted; everything is left in the run folder.

    A folder that holds checkpoints is gone on with from the newest, exactly as if the run had
    never been interrupted.

    Args:
        config: of the run.
        run: folder held for writing.
        condition: that ends episodes, in place of R* and C.

    Returns:
        The best policy by held-out success, as in the folder's `policy.npz`.

    Raises:
        NonFiniteError: a number became infinite or NaN.
        InterruptedRunError: a signal asked the run to stop.
    """
    trainer = Trainer(config, condition)
    checkpoints = Checkpoints(run.checkpoints)
    resuming = bool(checkpoints.steps())
    if resuming:
        like = jax.eval_shape(trainer.fresh_state)
        step, state, note = checkpoints.latest(like)
        best = note["best"]
    else:
        step, state, best = 0, trainer.fresh_state(), -1.0
        checkpoints.save(0, state, {"best": best})
    total = config.ppo.updates * config.ppo.batch
    with (
        MetricsLog(run.path, truncate_after_step=step if resuming else None) as log,
        Progress(total, start=step) as progress,
        Interruption() as interruption,
    ):
        _Session(trainer, run, checkpoints, log, progress, interruption, best).go_on(state)
    return read_policy(run.path / POLICY_FILE)


@dataclass
class _Session:
    """One sitting of a run: from a state to the end, or to an interruption."""

    trainer: Trainer
    run: RunFolder
    checkpoints: Checkpoints
    log: MetricsLog
    progress: Progress
    interruption: Interruption
    best: float

    def go_on(self, state: TrainState) -> None:
        config = self.trainer.config
        done = int(state.update)
        pending: list[tuple[int, dict[str, Array]]] = []
        while done < config.ppo.updates:
            state, metrics = self.trainer.train_step(self.trainer.world, state)
            done += 1
            pending.append((done, metrics))
            due = done % config.held_out.every == 0 or done == config.ppo.updates
            if due or self.interruption.requested:
                # The only point where the host waits for the device.
                rows = self._check(pending)
                pending = []
                verdict = self._examine(state) if due else {}
                self._record(rows, verdict)
                self._save(state, done, verdict)
            if self.interruption.requested and done < config.ppo.updates:
                raise InterruptedRunError(
                    f"interrupted after {done} of {config.ppo.updates} updates; all is saved: go on"
                    f" with  python train.py --resume {self.run.path}"
                )

    def _check(self, pending: list[tuple[int, dict[str, Array]]]) -> list[tuple[int, dict]]:
        """Fetch the metrics of the updates since the last check; stop at a non-finite number."""
        rows = jax.device_get(pending)
        for update, metrics in rows:
            bad = [name for name, fine in metrics.items() if "finite/" in name and not fine]
            if bad:
                where = ", ".join(name.removeprefix("finite/") for name in bad)
                step = update * self.trainer.config.ppo.batch
                raise NonFiniteError(
                    f"update {update} (step {step}) made non-finite numbers in: {where}; the last"
                    f" good state is kept in {self.run.checkpoints}: a smaller learning rate or"
                    " max_gradient_norm may help"
                )
        return rows

    def _examine(self, state: TrainState) -> dict[str, float]:
        verdict = self.trainer.examine(self.trainer.held_out, state.normaliser, state.averaged)
        return {name: float(value) for name, value in verdict.items()}

    def _record(self, rows: list[tuple[int, dict]], verdict: dict[str, float]) -> None:
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

    def _save(self, state: TrainState, done: int, verdict: dict[str, float]) -> None:
        score = verdict.get("held_out/reached")
        # Of equals the later: its learning rate was smaller and its average longer.
        if score is not None and score >= self.best:
            self.best = score
            write_policy(self.run.path / POLICY_FILE, self.trainer.policy(state))
        step = done * self.trainer.config.ppo.batch
        self.checkpoints.save(step, state, {"best": self.best}, best_score=score)
