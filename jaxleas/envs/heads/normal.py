"""A head of real numbers: a normal distribution, squashed into [-1, 1] by a tanh."""

import math
from dataclasses import dataclass

import jax
import jax.numpy as jnp
from flax import struct
from jax import Array
from jaxtyping import Float, Key

from jaxleas.envs.heads.scales import Scale
from jaxleas.envs.mirror import Mirror, require_mirror
from jaxleas.types import InputError, OnnxNodes

LOG_ROOT_TWO_PI = 0.5 * math.log(2.0 * math.pi)
MIN_DEVIATION = 1e-3  # as Brax has it


@struct.dataclass
class NormalDistribution:
    """The normal distribution of a raw action, before its tanh.

    Attributes:
        location: mean of the distribution.
        deviation: standard deviation.
    """

    location: Float[Array, "*batch size"]
    deviation: Float[Array, "*batch size"]


@dataclass(frozen=True)
class Normal:
    """Real numbers with physical bounds.

    Attributes:
        name: name of the part of the action.
        scales: physical scales of its numbers, one after another.
        mirror: image of an action when left and right are swapped: its values may change place and
            sign; None where there is no such symmetry.
        gain: factor from the network's answer to location and deviation: below 1, an untrained
            policy stays near the middle of its ranges.
    """

    name: str
    scales: tuple[Scale, ...]
    mirror: Mirror | None = None
    gain: float = 1.0

    def __post_init__(self) -> None:
        scales = self.scales
        if not (math.isfinite(self.gain) and self.gain > 0.0):
            raise InputError(
                f"the head {self.name!r} has the gain {self.gain}; give a finite number above 0"
            )
        if not isinstance(scales, tuple) or not scales or not all(map(callable, scales)):
            raise InputError(
                f"the head {self.name!r} has the scales {scales!r}; give a tuple of scales, such as"
                " (Interval(-1.0, 1.0),)"
            )
        require_mirror(self.mirror, self.size, f"the head {self.name!r}")

    @property
    def symmetric(self) -> bool:
        """Whether the head has a mirror."""
        return self.mirror is not None

    @property
    def size(self) -> int:
        """Length of an action."""
        return sum(scale.size for scale in self.scales)

    @property
    def logits(self) -> tuple[int, ...]:
        """Lengths of the locations, then of the values from which deviations are made."""
        return self.size, self.size

    @property
    def noise(self) -> int:
        """Number of random numbers that a sample takes."""
        return self.size

    @property
    def entropy_noise(self) -> int:
        """Number of standard normal numbers that an estimate of the entropy takes."""
        return self.size

    def draw_noise(self, key: Key[Array, ""], shape: tuple[int, ...]) -> Array:
        """Draw standard normal numbers."""
        return jax.random.normal(key, (*shape, self.size))

    def distribution(self, *logits: Array) -> NormalDistribution:
        """Return location and deviation, which a softplus keeps positive."""
        location, spread = logits
        deviation = self._amplified(jax.nn.softplus(spread))
        return NormalDistribution(self._amplified(location), deviation + MIN_DEVIATION)

    def sample(self, distribution: NormalDistribution, noise: Array) -> Array:
        """Return a raw action."""
        return distribution.location + distribution.deviation * noise

    def action(self, raw: Array) -> Array:
        """Return the tanh of a raw action."""
        return jnp.tanh(raw)

    def mode(self, *logits: Array) -> Array:
        """Return the tanh of the location."""
        return jnp.tanh(self._amplified(logits[0]))

    def command(self, action: Array) -> Array:
        """Return an action in physical units."""
        parts, begin = [], 0
        for scale in self.scales:
            parts.append(scale(action[..., begin : begin + scale.size]))
            begin += scale.size
        return jnp.concatenate(parts, axis=-1)

    def log_density(self, raw: Array, distribution: NormalDistribution) -> Array:
        """Return the log density of a raw action; the tanh's Jacobian is left out."""
        location, deviation = distribution.location, distribution.deviation
        distance = (raw - location) / deviation
        return jnp.sum(-0.5 * distance * distance - jnp.log(deviation) - LOG_ROOT_TWO_PI, axis=-1)

    def entropy(self, distribution: NormalDistribution, noise: Array) -> Array:
        """Return the entropy of the normal, plus the log slope of the tanh at one sample."""
        sample = self.sample(distribution, noise)
        entropy = 0.5 + LOG_ROOT_TWO_PI + jnp.log(distribution.deviation) + tanh_log_slope(sample)
        return jnp.sum(entropy, axis=-1)

    def divergence(self, before: NormalDistribution, now: NormalDistribution) -> Array:
        """Return KL(before || now)."""
        moved = jnp.square(before.location - now.location) + jnp.square(before.deviation)
        wider = jnp.log(now.deviation / before.deviation)
        return jnp.sum(wider + moved / (2.0 * jnp.square(now.deviation)) - 0.5, axis=-1)

    def mirrored_raw(self, raw: Array) -> Array:
        """Return a raw action with left and right swapped."""
        return self._mirror(raw)

    def mirrored(self, distribution: NormalDistribution) -> NormalDistribution:
        """Return a distribution with left and right swapped; deviations have no sign."""
        mirror = self._mirror
        return NormalDistribution(
            mirror(distribution.location), mirror.without_signs(distribution.deviation)
        )

    def _amplified(self, answer: Array) -> Array:
        return answer if self.gain == 1.0 else answer * self.gain

    @property
    def _mirror(self) -> Mirror:
        if self.mirror is None:
            raise ValueError(f"the head {self.name} has no mirror")
        return self.mirror

    def onnx(self, nodes: OnnxNodes, logits: str) -> str:
        """Add tanh and scales; the deviations in the network's answer are left out."""
        location = nodes.columns(logits, 0, self.size)
        return self.onnx_of_location(nodes, location, self.name)

    def onnx_of_location(self, nodes: OnnxNodes, location: str, output: str = "") -> str:
        """Add the nodes from the network's locations to the command."""
        if self.gain != 1.0:
            location = nodes.add("Mul", location, nodes.constant(self.gain))
        action = nodes.add("Tanh", location)
        parts, begin = [], 0
        for scale in self.scales:
            part = nodes.columns(action, begin, begin + scale.size)
            parts.append(scale.onnx(nodes, part))
            begin += scale.size
        return nodes.add("Concat", *parts, output=output, axis=1)


def tanh_log_slope(raw: Float[Array, "*batch size"]) -> Float[Array, "*batch size"]:
    """Return log(d tanh(x) / dx), in a form that never overflows."""
    return 2.0 * (math.log(2.0) - raw - jax.nn.softplus(-2.0 * raw))
