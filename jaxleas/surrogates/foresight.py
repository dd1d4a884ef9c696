"""A surrogate as a foresight: it ends an episode where its contact planner would fail.

In the thesis a guide path's tail is cut where the planner failed (T 4.2.2, Fig. 4.6), which is an
episode that terminates there. The surrogate knows a probability; the episode terminates where the
probability of having come so far falls below a level drawn once for the walk. That is inverse
transform sampling of the planner's verdict: as often, and in the same places, as it would fail.
"""

import jax
import jax.numpy as jnp
from flax import struct
from jax import Array
from jaxtyping import Float, Int

from jaxleas.surrogates.features import walk_features
from jaxleas.surrogates.surrogate import Surrogate
from jaxleas.types import InputError, RootMotion


@struct.dataclass
class Memory:
    """What is remembered of a walk.

    Attributes:
        hidden: the network's.
        last: motion at the last kept configuration.
        since: time steps since then.
        survival: probability that the planner got so far.
        level: below which the walk is over.
    """

    hidden: Float[Array, "*batch hidden"]
    last: RootMotion
    since: Int[Array, "*batch"]
    survival: Float[Array, "*batch"]
    level: Float[Array, "*batch"]


class SurrogateForesight:
    """A `Foresight` out of a surrogate.

    Margins are differences of probability: that of having come so far, less the walk's level.
    """

    def __init__(self, surrogate: Surrogate, threshold: float = 0.0):
        """Prepare the judge.

        Args:
            surrogate: that judges.
            threshold: the risk dial: levels are drawn in [threshold, 1]. 0 fails as often as the
                planner would; with 0.9 a walk that has come so far with less than 90 % never goes
                on, and policies learn to be careful beyond what the planner asks.

        Raises:
            InputError: the threshold is outside [0, 1).
        """
        if not 0.0 <= threshold < 1.0:
            raise InputError(f"the threshold is {threshold}; give a probability in [0, 1)")
        self.surrogate = surrogate
        self.threshold = threshold

    def begin(
        self,
        heights_in_root: Float[Array, "*batch P"],
        motion: RootMotion,
        chance: Float[Array, "*batch"],
    ) -> tuple[Float[Array, "*batch"], Memory]:
        """Judge the first configuration: can the robot stand here at all?"""
        batch = motion.yaw.shape
        memory = Memory(
            hidden=self.surrogate.begin(batch),
            last=motion,
            since=jnp.zeros(batch, jnp.int32),
            survival=jnp.ones(batch),
            level=self.threshold + (1.0 - self.threshold) * chance,
        )
        memory = self._keep(memory, heights_in_root, motion)
        return memory.survival - memory.level, memory

    def follow(
        self, memory: Memory, heights_in_root: Float[Array, "*batch P"], motion: RootMotion
    ) -> tuple[Float[Array, "*batch"], Memory]:
        """Judge the next configuration; the planner is asked about one in `keep_every`."""
        since = memory.since + 1
        kept = since >= self.surrogate.identity.keep_every
        after = self._keep(memory, heights_in_root, motion)

        def pick(new: Array, old: Array) -> Array:
            return jnp.where(kept.reshape(kept.shape + (1,) * (old.ndim - kept.ndim)), new, old)

        memory = jax.tree.map(pick, after, memory.replace(since=since))  # type: ignore[attr-defined]
        return memory.survival - memory.level, memory

    def _keep(self, memory: Memory, heights: Array, motion: RootMotion) -> Memory:
        identity = self.surrogate.identity
        features = walk_features(
            heights,
            motion,
            memory.last,
            identity.keep_every,
            (identity.height_low, identity.height_high),
        )
        hidden, hazard = self.surrogate.hazard(memory.hidden, features)
        return Memory(
            hidden=hidden,
            last=motion,
            since=jnp.zeros_like(memory.since),
            survival=memory.survival * (1.0 - hazard),
            level=memory.level,
        )
