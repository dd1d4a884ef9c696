"""The protocol of a network from vector to vector: in training, judged, as arrays, as ONNX."""

from collections.abc import Mapping
from typing import Any, Protocol

import numpy as np
from jax import Array
from jaxtyping import Float, Key

from jaxleas.types import OnnxNodes


class Network(Protocol):
    """A kind of network with its sizes; frozen and hashable, without its parameters.

    Attributes:
        inputs: length of the input: an observation's normalised values.
        outputs: length of the answer.
        activation: name of the activation between layers.
    """

    @property
    def activation(self) -> str:
        """Name of the activation between layers."""
        ...

    @property
    def inputs(self) -> int:
        """Length of the input."""
        ...

    @property
    def outputs(self) -> int:
        """Length of the answer."""
        ...

    def init(self, key: Key[Array, ""]) -> Any:
        """Return untrained parameters, a pytree."""
        ...

    def answer(
        self,
        params: Any,
        rows: Float[Array, "*batch inputs"],
        numbers: str = "float32",
    ) -> Float[Array, "*batch outputs"]:
        """Return the answer, float32, as training computes it.

        Args:
            params: parameters of the network.
            rows: normalised observations.
            numbers: number type in which products are computed.
        """
        ...

    def plain(
        self, params: Any, rows: Float[Array, "*batch inputs"]
    ) -> Float[Array, "*batch outputs"]:
        """Return the answer as it is judged and exported: float32, arranged for no device."""
        ...

    def arrays(self, params: Any) -> dict[str, Array]:
        """Return the parameters as plain arrays by name."""
        ...

    def parameters(self, arrays: Mapping[str, np.ndarray]) -> Any:
        """Return the parameters that `arrays` turned into named arrays.

        Raises:
            ValueError: an array is missing or of another shape.
        """
        ...

    def onnx(self, nodes: OnnxNodes, params: Any, rows: str) -> str:
        """Add the nodes that compute `plain`; return the name of the answer."""
        ...

    def describe(self) -> dict[str, Any]:
        """Return kind and sizes as plain JSON values: `network_described` reads them."""
        ...
