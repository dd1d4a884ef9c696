"""A surrogate as a foresight: it ends an episode where its contact planner would fail.

In the thesis a guide path's tail is cut where the planner failed (T 4.2.2, Fig. 4.6), which is an
episode that terminates there. The surrogate predicts a probability; the episode terminates where
the probability of having come this far falls below a level drawn once for the walk. That is inverse
transform sampling of the planner's verdict: it fails as often, and in the same places.
"""

import jax
import jax.numpy as jnp
from flax import struct
from jax import Array
from jaxtyping import Float, Int

from jaxleas.conditions import LookAround
from jaxleas.surrogates.features import path_features
from jaxleas.surrogates.surrogate import Surrogate
from jaxleas.surrogates.turns import all_at_once, in_turn
from jaxleas.types import InputError, RootMotion


@struct.dataclass
class Memory:
    """The state of a walk that the foresight carries along.

    Attributes:
        hidden: hidden state of the network.
        last: root motion at the last kept configuration.
        since: number of time steps since then.
        survival: probability that the planner got this far.
        level: level of the survival below which the walk ends.
    """

    hidden: Float[Array, "*batch hidden"]
    last: RootMotion
    since: Int[Array, "*batch"]
    survival: Float[Array, "*batch"]
    level: Float[Array, "*batch"]


class SurrogateForesight:
    """A `Foresight` made from a surrogate.

    Margins are differences of probability: that of having come this far, minus the walk's level.
    """

    def __init__(self, surrogate: Surrogate, threshold: float = 0.0, queue: bool = False):
        """Prepare the foresight.

        Args:
            surrogate: surrogate that judges.
            threshold: accepted risk: levels are drawn in [threshold, 1]. 0 fails as often as the
                planner would; with 0.9 a walk that has come this far with a probability below 90 %
                never continues, and policies learn to be more careful than the planner requires.
            queue: whether robots queue to be judged, for training with many of them: each step
                judges a little more than the average number of robots that are due; the others wait
                for the next step. Where all are due at once, as at the start of training, some wait
                for a few steps, after which they are due at different times.

        Raises:
            InputError: the threshold is outside [0, 1).
        """
        if not 0.0 <= threshold < 1.0:
            raise InputError(f"the threshold is {threshold}; give a probability in [0, 1)")
        self.surrogate = surrogate
        self.threshold = threshold
        self.queue = queue

    def begin(
        self,
        heights_in_root: Float[Array, "*batch P"],
        motion: RootMotion,
        chance: Float[Array, "*batch"],
    ) -> tuple[Float[Array, "*batch"], Memory]:
        """Judge the first configuration: whether the robot can stand there at all."""
        batch = motion.yaw.shape
        hidden = self.surrogate.begin(batch)
        near = self.surrogate.identity.near
        hidden, hazard = self._judge(hidden, heights_in_root[..., near], motion, motion)
        memory = Memory(
            hidden=hidden,
            last=motion,
            since=jnp.zeros(batch, jnp.int32),
            survival=1.0 - hazard,
            level=self.threshold + (1.0 - self.threshold) * chance,
        )
        return memory.survival - memory.level, memory

    def follow(
        self, memory: Memory, look_around: LookAround, motion: RootMotion
    ) -> tuple[Float[Array, "*batch"], Memory]:
        """Judge the next configuration; the planner is asked about one in `keep_every`."""
        near, keep_every = self.surrogate.identity.near, self.surrogate.identity.keep_every
        since = memory.since + 1
        due = since >= keep_every
        turn = in_turn(due, keep_every) if self.queue else all_at_once(due)
        hidden, last, now = jax.tree.map(turn.pick, (memory.hidden, memory.last, motion))
        hidden, hazard = self._judge(hidden, look_around(turn.pick, near), now, last)

        def where_served(new: Array, old: Array) -> Array:
            served = turn.served.reshape(due.shape + (1,) * (old.ndim - due.ndim))
            return jnp.where(served, new, old)

        survival = memory.survival * (1.0 - turn.give_back(hazard))
        memory = Memory(
            hidden=where_served(turn.give_back(hidden), memory.hidden),
            last=jax.tree.map(where_served, motion, memory.last),
            since=jnp.where(turn.served, 0, since),
            survival=where_served(survival, memory.survival),
            level=memory.level,
        )
        return memory.survival - memory.level, memory

    def _judge(
        self, hidden: Array, heights: Array, motion: RootMotion, last: RootMotion
    ) -> tuple[Array, Array]:
        """Return hidden state and hazard after a kept configuration."""
        identity = self.surrogate.identity
        height_range = identity.height_low, identity.height_high
        features = path_features(
            heights, motion, last, identity.keep_every, height_range, identity.pace
        )
        return self.surrogate.hazard(hidden, features)
