"""Members of a population that continue with what others have learned."""

import jax
import numpy as np
from jaxtyping import Bool, Int

from jaxleas.training import TrainState

LEARNED = ("params", "averaged", "optimiser", "normaliser")
OF_ROBOTS = ("episode", "observation", "failures")
"""Robots continue where they are, unless their own policy failed."""


def taken_over(
    states: TrainState, parents: Int[np.ndarray, " members"], failed: Bool[np.ndarray, " members"]
) -> TrainState:
    """Return the states after every member has copied what its parent learned.

    Args:
        states: states of all members.
        parents: number of the member that each one continues from.
        failed: whether each member's numbers became infinite or NaN; its robots are then copied,
            too.
    """
    of_robots = np.where(failed, parents, np.arange(len(parents)))
    source = dict.fromkeys(LEARNED, parents) | dict.fromkeys(OF_ROBOTS, of_robots)
    taken = {
        name: jax.tree.map(lambda leaf, index=index: leaf[index], getattr(states, name))
        for name, index in source.items()
    }
    return states.replace(**taken)  # type: ignore[attr-defined]
