"""A condition with memory: what is judged is the walk so far, not one configuration."""

from collections.abc import Callable
from typing import Any, Protocol

import numpy as np
from jax import Array
from jaxtyping import Float

from jaxleas.types import RootMotion

Pick = Callable[[Array], Array]
"""Takes some robots out of an array with one entry a robot."""
LookAround = Callable[[Pick, np.ndarray], Array]
"""Returns the local terrain of the robots picked [m], at those of a `Condition`'s points that have
these indices."""


def everyone(leaf: Array) -> Array:
    """Pick all robots."""
    return leaf


class Foresight(Protocol):
    """Anything that judges a walk step by step and remembers what it needs of it.

    A contact planner's verdict on a configuration depends on the stance it came with, so its
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
            motion: of the root.
            chance: uniform in [0, 1), drawn once for the walk: a foresight that knows a probability
                fails where that of having come so far falls below it. So its verdicts fall as the
                planner's would, and in the right place.

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
            memory: of the walk.
            look_around: shows local terrain; looking is dear, and who need not look does not.
            motion: of the root.
        """
        ...
