"""The protocol of a policy's head: a distribution of a part of the action."""

from typing import Any, Protocol

from jax import Array
from jaxtyping import Float, Key

from jaxleas.types import OnnxNodes


class Head(Protocol):
    """A part of the action, and how it is distributed; frozen and hashable.

    A *raw* action is what is stored and what densities are of; an *action* is what the
    environment takes; a *command* is the action in physical units.

    Attributes:
        name: name of the part, and of its ONNX output.
        size: length of a raw action.
        logits: lengths of the consecutive parts of the network's answer for it.
        noise: number of random numbers that a sample takes.
        entropy_noise: number of random numbers that an estimate of the entropy takes.
        symmetric: whether the head has a mirror: its image when left and right are swapped.
    """

    @property
    def name(self) -> str:
        """Name of the part of the action."""
        ...

    @property
    def symmetric(self) -> bool:
        """Whether `mirrored` and `mirrored_raw` can be called."""
        ...

    @property
    def size(self) -> int:
        """Length of a raw action."""
        ...

    @property
    def logits(self) -> tuple[int, ...]:
        """Lengths of the consecutive parts of the network's answer."""
        ...

    @property
    def noise(self) -> int:
        """Number of random numbers that a sample takes."""
        ...

    @property
    def entropy_noise(self) -> int:
        """Number of standard normal numbers that an estimate of the entropy takes."""
        ...

    def draw_noise(self, key: Key[Array, ""], shape: tuple[int, ...]) -> Array:
        """Draw the noise of samples in bulk: [*shape, noise]."""
        ...

    def distribution(self, *logits: Array) -> Any:
        """Return the distribution that the parts of the network's answer define."""
        ...

    def sample(self, distribution: Any, noise: Array) -> Float[Array, "*batch size"]:
        """Return a raw action."""
        ...

    def action(self, raw: Float[Array, "*batch size"]) -> Array:
        """Return the action of a raw action."""
        ...

    def mode(self, *logits: Array) -> Array:
        """Return the deterministic action, the mode of the distribution."""
        ...

    def command(self, action: Array) -> Array:
        """Return an action in physical units."""
        ...

    def log_density(self, raw: Array, distribution: Any) -> Float[Array, "*batch"]:
        """Return the log density of a raw action, without terms that no distribution changes."""
        ...

    def entropy(self, distribution: Any, noise: Array) -> Float[Array, "*batch"]:
        """Return the entropy of the action, or an estimate of it from one sample."""
        ...

    def divergence(self, before: Any, now: Any) -> Float[Array, "*batch"]:
        """Return KL(before || now)."""
        ...

    def mirrored_raw(self, raw: Float[Array, "*batch size"]) -> Float[Array, "*batch size"]:
        """Return a raw action with left and right swapped."""
        ...

    def mirrored(self, distribution: Any) -> Any:
        """Return a distribution with left and right swapped."""
        ...

    def onnx(self, nodes: OnnxNodes, logits: str) -> str:
        """Add the nodes from the network's answer to the command; return the command's name."""
        ...
