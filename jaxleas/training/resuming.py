"""Where a training begins: fresh, or from what its run folder holds, mended where damaged."""

import logging

from jaxleas.runs import (
    POLICY_FILE,
    Checkpoints,
    NoCheckpointError,
    RunFolder,
)
from jaxleas.training.beginning import begun_with
from jaxleas.training.policy import read_policy, write_policy
from jaxleas.training.processes import from_first
from jaxleas.training.train_state import Learned, TrainState
from jaxleas.training.trainer import Trainer
from jaxleas.types import InputError

_LOG = logging.getLogger("jaxleas")


def first_state(
    trainer: Trainer, checkpoints: Checkpoints | None, learned: Learned | None = None
) -> tuple[int, TrainState, float]:
    """Return step, state and best score to continue from: the newest checkpoint's, or fresh ones.

    Only process 0 has checkpoints; the other processes get its state.

    Args:
        trainer: compiled programs of the training.
        checkpoints: checkpoints of the run; None on other processes.
        learned: networks to begin with, in place of fresh ones.
    """
    like = trainer.shapes
    found = None

    def look() -> str:
        nonlocal found
        if checkpoints is not None and checkpoints.steps():
            found = _latest(checkpoints, like)
        return "fresh" if found is None else "resumed"

    if from_first(look) == "resumed":
        step, state, note = found or (0, like, {"best": -1.0})
        return step, trainer.place(state), _best_score(note, step)
    state = trainer.fresh_state()
    if learned is None:
        learned = begun_with(trainer.config, trainer.networks, state)
    if learned is not None:
        state = trainer.place(learned.into(state))
    kept = trainer.gather(state)
    if checkpoints is not None:
        checkpoints.save(0, kept, {"best": -1.0})
    return 0, state, -1.0


def _best_score(note: dict, step: int) -> float:
    """Return the best score so far, as the note of a checkpoint states it."""
    best = note.get("best")
    if isinstance(best, bool) or not isinstance(best, int | float):
        raise InputError(
            f"the checkpoint of step {step} is not a training's: its note states no number 'best'"
        )
    return float(best)


def _latest(checkpoints: Checkpoints, like: TrainState) -> tuple[int, TrainState, dict] | None:
    """Return the newest state; None if only the very first was written, and it is lost."""
    try:
        return checkpoints.latest(like)
    except NoCheckpointError as error:
        if checkpoints.steps() != [0]:
            raise
        _LOG.warning("%s: no step had been done yet, so training begins anew", error)
        return None


def mended_best(trainer: Trainer, run: RunFolder, checkpoints: Checkpoints, best: float) -> float:
    """Make a damaged `policy.npz` again from the best checkpoint; return its score."""
    if best < 0.0:
        return best  # no policy was written yet
    try:
        read_policy(run.path / POLICY_FILE, of=trainer.config.env)
    except InputError as damage:
        try:
            step, state, _ = checkpoints.best(trainer.shapes)
        except InputError as error:
            _LOG.warning("%s; %s: the best policy from here on is kept", damage, error)
            return -1.0
        write_policy(run.path / POLICY_FILE, trainer.policy(state))
        _LOG.warning("%s; it is made again from the checkpoint of step %d", damage, step)
    return best
