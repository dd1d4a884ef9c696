"""The worlds that robots train in and are examined in: never from the same seeds."""

from typing import Any

from jaxleas.envs import Task
from jaxleas.terrain import HELD_OUT_SEED, MAX_TRAINING_SEED
from jaxleas.training.config import RunConfig
from jaxleas.types import InputError


def training_world(config: RunConfig, task: Task) -> Any:
    """Return the world to train in.

    Raises:
        InputError: the seeds of its arenas would leave the training range.
    """
    terrain = config.terrain
    last = terrain.first_seed + terrain.arenas - 1
    if last > MAX_TRAINING_SEED:
        raise InputError(
            f"terrain.first_seed + terrain.arenas reaches seed {last}, but seeds above"
            f" {MAX_TRAINING_SEED} are kept for evaluation: give a smaller first_seed"
        )
    return task.make_world(range(terrain.first_seed, last + 1), examined=False)


def held_out_world(config: RunConfig, task: Task) -> Any:
    """Return the world of the examination: the same kind, from seeds never trained on."""
    seeds = range(HELD_OUT_SEED, HELD_OUT_SEED + config.held_out.arenas)
    return task.make_world(seeds, examined=True)
