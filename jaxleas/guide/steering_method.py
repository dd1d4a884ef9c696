"""The steering method's protocol: from local terrain, root motion and goal to the next motion."""

from typing import Literal, Protocol

from jax import Array
from jaxtyping import Float

from jaxleas.types import RootMotion


class SteeringMethod(Protocol):
    """A callable that moves roots one time step towards their goals (T sec. 3.1.1).

    `roll_out` calls it. A method that is a pytree (a `flax.struct` dataclass) may change its arrays
    without a new compilation; any other callable works too and is compiled once for each object.
    Where it has an attribute `guarded` that is true, the environment's guard, if there is one,
    watches over the motion that it returns.
    """

    def __call__(
        self,
        heights_in_root: Float[Array, "*batch points"],
        motion: RootMotion,
        goal: Float[Array, "*batch 3"],
    ) -> RootMotion:
        """Return the root motion one time step later; pure JAX, for any batch.

        Args:
            heights_in_root: the environment's local heights, relative to the root [m].
            motion: current root motion.
            goal: goal in the world: x, y, and the root's height wanted there [m].
        """
        ...


class HostSteeringMethod(SteeringMethod, Protocol):
    """A steering method that computes outside JAX; `roll_out` calls it from a Python loop."""

    @property
    def runs_on_host(self) -> Literal[True]:
        """Return True: `roll_out` cannot trace this method."""
        ...
