"""A head that chooses one of several options."""

from dataclasses import dataclass

import jax
import jax.numpy as jnp
import numpy as np
from flax import struct
from jax import Array
from jaxtyping import Float, Int, Key

from jaxleas.types import OnnxNodes


@struct.dataclass
class CategoricalDistribution:
    """Probabilities of the choices.

    Attributes:
        log_probability: logarithm of each choice's probability.
    """

    log_probability: Float[Array, "*batch choices"]


@dataclass(frozen=True)
class Categorical:
    """One of several choices, an index; a raw action holds it as a float, exactly.

    Attributes:
        name: name of the part of the action.
        choices: number of choices.
        mirror_order: choice that each choice becomes when left and right are swapped; it is its
            own inverse, as swapping twice changes nothing; None where there is no such symmetry.
    """

    name: str
    choices: int
    mirror_order: tuple[int, ...] | None = None

    def __post_init__(self) -> None:
        order = self.mirror_order
        if order is not None and [order[place] for place in order] != list(range(self.choices)):
            raise ValueError(f"mirror_order = {order} must be its own inverse on {self.choices}")

    @property
    def size(self) -> int:
        """Length of a raw action: the index alone."""
        return 1

    @property
    def logits(self) -> tuple[int, ...]:
        """Length of the network's answer: one number for each choice."""
        return (self.choices,)

    @property
    def noise(self) -> int:
        """Number of random numbers that a sample takes."""
        return self.choices

    @property
    def entropy_noise(self) -> int:
        """Zero: the entropy is a sum over the choices and needs no samples."""
        return 0

    @property
    def symmetric(self) -> bool:
        """Whether the head has a mirror."""
        return self.mirror_order is not None

    def mirrored_raw(self, raw: Float[Array, "*batch 1"]) -> Float[Array, "*batch 1"]:
        """Return the choice that each choice becomes when left and right are swapped."""
        order = jnp.asarray(self.mirror_order, jnp.float32)
        return order.at[raw.astype(jnp.int32)].get(mode="clip")

    def draw_noise(self, key: Key[Array, ""], shape: tuple[int, ...]) -> Array:
        """Draw Gumbel noise: the choice with the largest sum of noise and logarithm is a sample."""
        return jax.random.gumbel(key, (*shape, self.choices))

    def distribution(self, *logits: Array) -> CategoricalDistribution:
        """Return the logarithm of the softmax."""
        return CategoricalDistribution(jax.nn.log_softmax(logits[0], axis=-1))

    def sample(self, distribution: CategoricalDistribution, noise: Array) -> Array:
        """Return a raw action: the choice's index."""
        choice = jnp.argmax(distribution.log_probability + noise, axis=-1)
        return choice[..., None].astype(jnp.float32)

    def action(self, raw: Float[Array, "*batch 1"]) -> Int[Array, "*batch"]:
        """Return the choice."""
        return raw[..., 0].astype(jnp.int32)

    def mode(self, *logits: Array) -> Int[Array, "*batch"]:
        """Return the most likely choice, the first of equals."""
        return jnp.argmax(logits[0], axis=-1).astype(jnp.int32)

    def command(self, action: Int[Array, "*batch"]) -> Int[Array, "*batch"]:
        """Return the choice: it has no unit."""
        return action

    def log_density(self, raw: Array, distribution: CategoricalDistribution) -> Array:
        """Return the logarithm of the choice's probability."""
        chosen = jax.nn.one_hot(raw[..., 0].astype(jnp.int32), self.choices)
        return jnp.sum(chosen * distribution.log_probability, axis=-1)

    def entropy(self, distribution: CategoricalDistribution, noise: Array) -> Array:
        """Return the entropy of the distribution."""
        del noise
        logs = distribution.log_probability
        return -jnp.sum(jnp.exp(logs) * logs, axis=-1)

    def divergence(self, before: CategoricalDistribution, now: CategoricalDistribution) -> Array:
        """Return KL(before || now)."""
        logs = before.log_probability
        return jnp.sum(jnp.exp(logs) * (logs - now.log_probability), axis=-1)

    def mirrored(self, distribution: CategoricalDistribution) -> CategoricalDistribution:
        """Return a distribution with left and right swapped."""
        # The order is its own inverse, so that it maps in both directions.
        order = np.asarray(self.mirror_order)
        return CategoricalDistribution(distribution.log_probability[..., order])

    def onnx(self, nodes: OnnxNodes, logits: str) -> str:
        """Add the search for the largest; the output is of type int64."""
        return nodes.add("ArgMax", logits, output=self.name, axis=1, keepdims=0)
