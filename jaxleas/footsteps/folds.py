"""What a model is judged on: footsteps, or whole runs, that it has not seen."""

from typing import Literal

import numpy as np
from jaxtyping import Int

Split = Literal["run", "random"]
SPLITS: tuple[Split, ...] = ("run", "random")
RANDOM_FOLDS = 5
"""A fifth of the footsteps is held out at a time, as in the thesis (section 4.1.4)."""
MOST_RUNS_ALONE = 25
"""Up to this number of runs each is held out alone; of more, a tenth at a time."""
RUN_FOLDS = 10


def folds_of(split: Split, run: Int[np.ndarray, " N"], seed: int) -> Int[np.ndarray, " N"]:
    """Return the number of the fold that each footstep is in.

    Args:
        split: "run": footsteps of a run are in one fold; "random": each is by itself.
        run: number of each footstep's run.
        seed: seed of the order in which footsteps or runs are dealt out.
    """
    generator = np.random.default_rng(seed)
    if split == "random":
        return generator.permutation(len(run)) % RANDOM_FOLDS
    runs, index = np.unique(run, return_inverse=True)
    folds = len(runs) if len(runs) <= MOST_RUNS_ALONE else RUN_FOLDS
    return (generator.permutation(len(runs)) % folds)[index.reshape(-1)]
