"""A condition with memory: it judges the walk so far, not one configuration."""

from collections.abc import Callable
from typing import Any, Protocol

import numpy as np
from jax import Array
from jaxtyping import Float

from jaxleas.types import RootMotion

Pick = Callable[[Array], Array]
"""Takes some robots out of an array with one entry per robot."""
LookAround = Callable[[Pick, np.ndarray], Array]
"""Returns the local terrain of the picked robots [m] at the points of a `Condition` with these
indices."""


def everyone(leaf: Array) -> Array:
    """Pick all robots."""
    return leaf


class Foresight(Protocol):
    """A condition on a walk, judged step by step, which remembers what it needs of it.

    A contact planner's verdict on a configuration depends on the stance before it, so its
    learned stand-in needs memory, which the environment keeps in the state of the episode.
    """

    def begin(
        self,
        heights_in_root: Float[Array, "*batch P"],
        motion: RootMotion,
        chance: Float[Array, "*batch"],
    ) -> tuple[Float[Array, "*batch"], Any]:
        """Judge the first configuration of a walk.

        Args:
            heights_in_root: local terrain, as a `Condition` takes it [m].
            motion: motion of the root.
            chance: uniform number in [0, 1), drawn once for the walk: a foresight that knows a
                probability fails where the probability of having come so far falls below it. So it
                fails as often as the planner would, and in the right places.

        Returns:
            Signed margin, positive where satisfied, and the memory: a pytree with the batch's axes
            first in every leaf.
        """
        ...

    def follow(
        self, memory: Any, look_around: LookAround, motion: RootMotion
    ) -> tuple[Float[Array, "*batch"], Any]:
        """Judge the next configuration of the walk; return margin and memory, as `begin` does.

        Args:
            memory: memory of the walk.
            look_around: function that returns local terrain; it is expensive, so call it only if
                needed.
            motion: motion of the root.
        """
        ...
