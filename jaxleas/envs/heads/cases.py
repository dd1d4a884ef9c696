"""A head that chooses one of several cases, and gives the numbers that belong to that case."""

from dataclasses import dataclass

import jax
import jax.numpy as jnp
import numpy as np
from flax import struct
from jax import Array
from jaxtyping import Float, Key

from jaxleas.envs.heads.categorical import Categorical, CategoricalDistribution
from jaxleas.envs.heads.normal import Normal, NormalDistribution
from jaxleas.types import InputError, OnnxNodes


@struct.dataclass
class CasesDistribution:
    """Probabilities of the cases, and the distribution of the numbers in each.

    Attributes:
        choice: probabilities of the cases.
        numbers: location and deviation of the numbers in each case [*batch, cases, size].
    """

    choice: CategoricalDistribution
    numbers: NormalDistribution


@dataclass(frozen=True)
class Cases:
    """One of several cases, and numbers whose distribution depends on the case.

    Two heads, one for the choice and one for the numbers, draw the numbers without knowing the
    choice: where each case needs numbers of its own, they fit none. An action holds the numbers
    first, and the index of the case last, as a float, exactly.

    Attributes:
        name: name of the part of the action.
        choice: head of the case.
        numbers: head of the numbers.
    """

    name: str
    choice: Categorical
    numbers: Normal

    def __post_init__(self) -> None:
        if self.choice.symmetric != self.numbers.symmetric:
            raise InputError(
                f"the head {self.name!r} has a mirror for its choice or for its numbers alone: give"
                " both, or none"
            )

    @property
    def symmetric(self) -> bool:
        """Whether the head has a mirror."""
        return self.choice.symmetric

    @property
    def size(self) -> int:
        """Length of a raw action: the numbers, and the index of the case."""
        return self.numbers.size + 1

    @property
    def logits(self) -> tuple[int, ...]:
        """Lengths of locations and spreads, case by case, and of one number for each case."""
        count = self.choice.choices
        return count * self.numbers.size, count * self.numbers.size, count

    @property
    def noise(self) -> int:
        """Number of random numbers that a sample takes."""
        return self.numbers.noise + self.choice.noise

    @property
    def entropy_noise(self) -> int:
        """Number of standard normal numbers that an estimate of the entropy takes."""
        return self.numbers.entropy_noise

    def draw_noise(self, key: Key[Array, ""], shape: tuple[int, ...]) -> Array:
        """Draw the noise of the numbers, and that of the choice."""
        of_numbers, of_choice = jax.random.split(key)
        parts = self.numbers.draw_noise(of_numbers, shape), self.choice.draw_noise(of_choice, shape)
        return jnp.concatenate(parts, axis=-1)

    def distribution(self, *logits: Array) -> CasesDistribution:
        """Return the distribution of the choice, and that of the numbers in each case."""
        locations, spreads, choice = logits
        numbers = self.numbers.distribution(self._by_case(locations), self._by_case(spreads))
        return CasesDistribution(self.choice.distribution(choice), numbers)

    def sample(self, distribution: CasesDistribution, noise: Array) -> Array:
        """Return a raw action."""
        size = self.numbers.size
        choice = self.choice.sample(distribution.choice, noise[..., size:])
        of_case = numbers_of(distribution, choice[..., 0])
        return jnp.concatenate([self.numbers.sample(of_case, noise[..., :size]), choice], axis=-1)

    def action(self, raw: Float[Array, "*batch size"]) -> Float[Array, "*batch size"]:
        """Return the numbers within [-1, 1], and the index of the case."""
        return jnp.concatenate([self.numbers.action(raw[..., :-1]), raw[..., -1:]], axis=-1)

    def mode(self, *logits: Array) -> Float[Array, "*batch size"]:
        """Return the most likely case, the first of equals, and the mode of its numbers."""
        distribution = self.distribution(*logits)
        choice = jnp.argmax(distribution.choice.log_probability, axis=-1)
        location = numbers_of(distribution, choice).location
        return self.action(jnp.concatenate([location, choice[..., None]], axis=-1))

    def command(self, action: Float[Array, "*batch size"]) -> Float[Array, "*batch size"]:
        """Return the numbers in physical units, and the index of the case."""
        return jnp.concatenate([self.numbers.command(action[..., :-1]), action[..., -1:]], axis=-1)

    def log_density(self, raw: Array, distribution: CasesDistribution) -> Float[Array, "*batch"]:
        """Return log p(case) + log p(numbers | case)."""
        of_case = numbers_of(distribution, raw[..., -1])
        chosen = self.choice.log_density(raw[..., -1:], distribution.choice)
        return chosen + self.numbers.log_density(raw[..., :-1], of_case)

    def entropy(self, distribution: CasesDistribution, noise: Array) -> Float[Array, "*batch"]:
        """Return the entropy of the case, and the mean one of its numbers, from one sample each."""
        each = self.numbers.entropy(distribution.numbers, noise[..., None, :])
        likely = jnp.exp(distribution.choice.log_probability)
        return self.choice.entropy(distribution.choice, noise) + jnp.sum(likely * each, axis=-1)

    def divergence(
        self, before: CasesDistribution, now: CasesDistribution
    ) -> Float[Array, "*batch"]:
        """Return KL(before || now): that of the case, and the mean one of its numbers."""
        each = self.numbers.divergence(before.numbers, now.numbers)
        likely = jnp.exp(before.choice.log_probability)
        return self.choice.divergence(before.choice, now.choice) + jnp.sum(likely * each, axis=-1)

    def mirrored_raw(self, raw: Float[Array, "*batch size"]) -> Float[Array, "*batch size"]:
        """Return a raw action with left and right swapped."""
        parts = self.numbers.mirrored_raw(raw[..., :-1]), self.choice.mirrored_raw(raw[..., -1:])
        return jnp.concatenate(parts, axis=-1)

    def mirrored(self, distribution: CasesDistribution) -> CasesDistribution:
        """Return a distribution with left and right swapped, the numbers with their cases."""
        image = self.numbers.mirrored(distribution.numbers)
        order = jnp.asarray(self.choice.mirror_order)
        numbers = jax.tree.map(lambda leaf: leaf[..., order, :], image)
        return CasesDistribution(self.choice.mirrored(distribution.choice), numbers)

    def onnx(self, nodes: OnnxNodes, logits: str) -> str:
        """Add the choice of the case, and the scaled numbers that belong to it."""
        size, count = self.numbers.size, self.choice.choices
        locations = nodes.columns(logits, 0, count * size)
        scores = nodes.columns(logits, 2 * count * size, 2 * count * size + count)
        index = nodes.add("ArgMax", scores, axis=1, keepdims=1)
        depth, ends = nodes.constant([count], np.int64), nodes.constant([0.0, 1.0])
        hot = nodes.add("OneHot", index, depth, ends, axis=2)  # [batch, 1, cases]
        shape = nodes.constant([-1, count, size], np.int64)
        chosen = nodes.add("MatMul", hot, nodes.add("Reshape", locations, shape))
        flat = nodes.add("Reshape", chosen, nodes.constant([-1, size], np.int64))
        numbers = self.numbers.onnx_of_location(nodes, flat)
        case = nodes.add("Cast", index, to=1)  # float32
        return nodes.add("Concat", numbers, case, output=self.name, axis=1)

    def _by_case(self, values: Array) -> Array:
        return values.reshape(*values.shape[:-1], self.choice.choices, self.numbers.size)


def numbers_of(distribution: CasesDistribution, case: Float[Array, "*batch"]) -> NormalDistribution:
    """Return the distribution of the numbers in one case of each row."""
    numbers = distribution.numbers
    hot = jax.nn.one_hot(case.astype(jnp.int32), numbers.location.shape[-2])[..., None]
    return jax.tree.map(lambda leaf: jnp.sum(hot * leaf, axis=-2), numbers)
