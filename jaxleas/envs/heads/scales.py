"""From a normal head's numbers in [-1, 1] to physical units, in JAX and as ONNX nodes."""

import math
from dataclasses import dataclass
from typing import Protocol

import jax.numpy as jnp
from jax import Array
from jaxtyping import Float

from jaxleas.geometry import bound_norm
from jaxleas.types import InputError, OnnxNodes


class Scale(Protocol):
    """A scale of some consecutive numbers of an action.

    Attributes:
        size: number of values.
    """

    @property
    def size(self) -> int:
        """Number of values."""
        ...

    def __call__(self, action: Float[Array, "*batch size"]) -> Float[Array, "*batch size"]:
        """Return physical values; actions outside [-1, 1] are clipped."""
        ...

    def onnx(self, nodes: OnnxNodes, action: str) -> str:
        """Add the nodes that scale a value within [-1, 1]; return the name of their result."""
        ...


@dataclass(frozen=True)
class Interval:
    """Numbers, each within the same bounds.

    Attributes:
        low: physical value of -1.
        high: physical value of 1.
        size: number of values.
    """

    low: float
    high: float
    size: int = 1

    def __post_init__(self) -> None:
        width = self.high - self.low
        if not (math.isfinite(width) and width > 0.0):
            raise InputError(f"{self} is not an interval: give finite numbers, low below high")
        _require_size(self)

    def __call__(self, action: Float[Array, "*batch size"]) -> Float[Array, "*batch size"]:
        """Return low + (action + 1) / 2 (high - low)."""
        scaled = jnp.clip(action, -1.0, 1.0) * (0.5 * (self.high - self.low))
        return scaled + self._centre if self._centre else scaled

    def onnx(self, nodes: OnnxNodes, action: str) -> str:
        """Add the nodes that compute the same."""
        scaled = nodes.add("Mul", action, nodes.constant(0.5 * (self.high - self.low)))
        return nodes.add("Add", scaled, nodes.constant(self._centre)) if self._centre else scaled

    @property
    def _centre(self) -> float:
        return 0.5 * (self.low + self.high)


@dataclass(frozen=True)
class Ball:
    """A vector whose norm is bounded.

    Attributes:
        radius: largest norm, in physical units.
        size: number of its components.
    """

    radius: float
    size: int = 3

    def __post_init__(self) -> None:
        if not (math.isfinite(self.radius) and self.radius > 0.0):
            raise InputError(f"{self} is not a ball: give a finite radius above 0")
        _require_size(self)

    def __call__(self, action: Float[Array, "*batch size"]) -> Float[Array, "*batch size"]:
        """Return radius * action, shortened where the action is longer than 1."""
        return bound_norm(jnp.clip(action, -1.0, 1.0), 1.0) * self.radius

    def onnx(self, nodes: OnnxNodes, action: str) -> str:
        """Add the nodes that compute the same."""
        norm = nodes.add("ReduceL2", action, axes=[1], keepdims=1)
        bounded = nodes.add("Div", action, nodes.add("Max", norm, nodes.constant(1.0)))
        return nodes.add("Mul", bounded, nodes.constant(self.radius))


def _require_size(scale: Scale) -> None:
    if not isinstance(scale.size, int) or scale.size < 1:
        raise InputError(f"{scale} scales {scale.size} values; give a whole number, 1 at least")
