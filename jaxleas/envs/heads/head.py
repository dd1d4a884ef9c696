"""What a head of a policy is: a distribution of a part of the action."""

from typing import Any, Protocol

from jax import Array
from jaxtyping import Float, Key

from jaxleas.types.onnx_nodes import OnnxNodes


class Head(Protocol):
    """A part of the action, and how it is distributed; frozen and hashable.

    A *raw* action is what is stored and what densities are about; an *action* is what the
    environment takes; a *command* is the same in physical units.

    Attributes:
        name: name of the part, of its ONNX output, too.
        size: numbers in a raw action.
        logits: numbers that the network answers for it.
        noise: random numbers that a sample takes.
        entropy_noise: random numbers that an estimate of the entropy takes.
        symmetric: whether it is known what becomes of it when left and right are swapped.
    """

    @property
    def name(self) -> str:
        """Name of the part of the action."""
        ...

    @property
    def symmetric(self) -> bool:
        """Whether `mirrored` and `mirrored_raw` can be asked for."""
        ...

    @property
    def size(self) -> int:
        """Numbers in a raw action."""
        ...

    @property
    def logits(self) -> tuple[int, ...]:
        """Lengths of the consecutive parts of what the network answers."""
        ...

    @property
    def noise(self) -> int:
        """Random numbers that a sample takes."""
        ...

    @property
    def entropy_noise(self) -> int:
        """Standard normal numbers that an estimate of the entropy takes."""
        ...

    def draw_noise(self, key: Key[Array, ""], shape: tuple[int, ...]) -> Array:
        """Draw the chance of samples in bulk: [*shape, noise]."""
        ...

    def distribution(self, *logits: Array) -> Any:
        """Return the distribution that the parts of the network's answer stand for."""
        ...

    def sample(self, distribution: Any, noise: Array) -> Float[Array, "*batch size"]:
        """Return a raw action."""
        ...

    def action(self, raw: Float[Array, "*batch size"]) -> Array:
        """Return the action that a raw one stands for."""
        ...

    def mode(self, *logits: Array) -> Array:
        """Return the action without chance."""
        ...

    def command(self, action: Array) -> Array:
        """Return an action in physical units."""
        ...

    def log_density(self, raw: Array, distribution: Any) -> Float[Array, "*batch"]:
        """Return the log density of a raw action, less what no distribution changes."""
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
