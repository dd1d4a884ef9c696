"""What a condition is: local heights and a root motion in, a signed margin out."""

from typing import Protocol

import jax.numpy as jnp
from jax import Array
from jaxtyping import Float

from jaxleas.types import InputError, RootMotion
from jaxleas.types.ground import NO_GROUND_IN_ROOT

VOID_IN_ROOT = NO_GROUND_IN_ROOT
"""Height in the root frame [m] at or below which there is no ground."""

MARGIN_LIMIT = 1.0
"""Margins are clipped to +- this [m]: always finite, even over the void."""


class Condition(Protocol):
    """Anything that judges a configuration: an analytic condition or a learned surrogate."""

    def __call__(
        self, heights_in_root: Float[Array, "*batch P"], motion: RootMotion
    ) -> Float[Array, "*batch"]:
        """Return the signed margin, positive where the condition is satisfied.

        Args:
            heights_in_root: height of the terrain under each grid point minus the root's z [m];
                `VOID_IN_ROOT` or less where there is no ground.
            motion: of the root; the analytic conditions pass over it.

        Returns:
            Margin [m], clipped to +- `MARGIN_LIMIT`.
        """
        ...


def all_of(*conditions: Condition) -> Condition:
    """Return the condition that holds where all of `conditions` do: the least of their margins.

    Raises:
        InputError: no condition is given.
    """
    if not conditions:
        raise InputError("all_of needs at least one condition")

    def judge(
        heights_in_root: Float[Array, "*batch P"], motion: RootMotion
    ) -> Float[Array, "*batch"]:
        margin = conditions[0](heights_in_root, motion)
        for condition in conditions[1:]:
            margin = jnp.minimum(margin, condition(heights_in_root, motion))
        return margin

    return judge
