"""The writer of a training's rows, checkpoints and best policy, on process 0."""

from collections.abc import Callable
from dataclasses import dataclass

import jax
import numpy as np

from jaxleas.runs import (
    POLICY_FILE,
    Background,
    Checkpoints,
    MetricsLog,
    Progress,
    RunFolder,
)
from jaxleas.training.examination import REACHED, WORST
from jaxleas.training.policy import write_policy
from jaxleas.training.stretches import (
    Stretch,
    numbers,
)
from jaxleas.training.train_state import TrainState
from jaxleas.training.trainer import Trainer


@dataclass
class Recorder:
    """Writer of what all processes have computed, on process 0.

    Attributes:
        trainer: compiled programs of the training.
        run: folder held for writing.
        checkpoints: checkpoints of the run.
        log: log of its metrics.
        progress: line that shows how far it is.
        background: thread that writes.
        best: highest held-out score so far, the share of goals reached or, if the task asks for it,
            the success of the worst cell; -1 before the first examination.
        on_examined: function that is called after each examination.
    """

    trainer: Trainer
    run: RunFolder
    checkpoints: Checkpoints
    log: MetricsLog
    progress: Progress
    background: Background
    best: float
    on_examined: Callable[[], None]

    def record(self, stretch: Stretch, fractions: dict[str, float]) -> None:
        """Log each update, with the examination in the last row, and show how far it is."""
        batch, metrics = self.trainer.config.ppo.batch, {}
        for update, metrics in stretch.rows:
            last = update == stretch.done
            self.log.append(update * batch, numbers(metrics) | (fractions if last else {}))
        shown = {"return": f"{float(metrics['walk/reward']):.3f} per step"}
        if fractions:
            shown["held out"] = f"{100 * fractions[REACHED]:.1f} %"
        self.progress.update(stretch.done * batch, shown)

    def save(self, state: TrainState, done: int, fractions: dict[str, float]) -> None:
        """Write the state, and the policy if it is the best, while the training continues."""
        score = fractions.get(WORST, fractions.get(REACHED))
        policy = None
        # Between equals the later wins: its learning rate was smaller and its average longer.
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
        if fractions:
            self.on_examined()
