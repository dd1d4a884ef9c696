"""A perceptron of several layers, with parameters laid out as Brax does."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import jax.numpy as jnp
import numpy as np
from jax import Array
from jaxtyping import Float, Key

from jaxleas.training.brax_blocks import ACTIVATION, MLP
from jaxleas.training.networks.activations import onnx_activation
from jaxleas.types import OnnxNodes
from jaxleas.xla import dense, plain_dense


@dataclass(frozen=True)
class Mlp:
    """Dense layers with an activation between them.

    Attributes:
        inputs: length of the input.
        hidden: sizes of the hidden layers.
        outputs: length of the answer.
        activation: name of the activation.
    """

    inputs: int
    hidden: tuple[int, ...]
    outputs: int
    activation: str

    def init(self, key: Key[Array, ""]) -> Any:
        """Return untrained parameters: LeCun's uniform kernels, biases of zero."""
        layers = MLP(layer_sizes=[*self.hidden, self.outputs], activation=ACTIVATION["relu"])
        return layers.init(key, jnp.zeros((1, self.inputs)))

    def answer(
        self,
        params: Any,
        rows: Float[Array, "*batch inputs"],
        numbers: str = "float32",
    ) -> Float[Array, "*batch outputs"]:
        """Return the answer as training computes it (`Network.answer`)."""
        return dense(layers_of(params), rows, ACTIVATION[self.activation], numbers)

    def plain(
        self, params: Any, rows: Float[Array, "*batch inputs"]
    ) -> Float[Array, "*batch outputs"]:
        """Return the answer as it is judged."""
        return plain_dense(layers_of(params), rows, ACTIVATION[self.activation])

    def arrays(self, params: Any) -> dict[str, Array]:
        """Return kernel_0, bias_0, kernel_1 and so on."""
        return {
            f"{part}_{index}": array
            for index, layer in enumerate(layers_of(params))
            for part, array in zip(("kernel", "bias"), layer, strict=True)
        }

    def parameters(self, arrays: Mapping[str, np.ndarray]) -> Any:
        """Return the parameters that `arrays` turned into named arrays."""
        sizes = [self.inputs, *self.hidden, self.outputs]
        layers = []
        for index in range(len(sizes) - 1):
            shapes = {f"kernel_{index}": tuple(sizes[index : index + 2])}
            shapes[f"bias_{index}"] = (sizes[index + 1],)
            layers.append([array_of_shape(arrays, *each) for each in shapes.items()])
        return params_of(layers)

    def onnx(self, nodes: OnnxNodes, params: Any, rows: str) -> str:
        """Add a Gemm per layer, and the activations between."""
        layers = layers_of(params)
        for index, (kernel, bias) in enumerate(layers):
            rows = nodes.add("Gemm", rows, nodes.constant(kernel), nodes.constant(bias))
            if index < len(layers) - 1:
                rows = onnx_activation(nodes, self.activation, rows)
        return rows

    def describe(self) -> dict[str, Any]:
        """Return the kind and sizes of the network."""
        return {"kind": "mlp", "hidden": list(self.hidden)}


def layers_of(params: Any) -> list[tuple[Array, Array]]:
    """Return kernel and bias of each layer, from the first to the last."""
    layers = params["params"]
    names = sorted(layers, key=lambda name: int(name.removeprefix("hidden_")))
    return [(layers[name]["kernel"], layers[name]["bias"]) for name in names]


def params_of(layers: Sequence[Sequence[Any]]) -> Any:
    """Return parameters made of the kernel and bias of each layer."""
    return {
        "params": {
            f"hidden_{index}": {"kernel": kernel, "bias": bias}
            for index, (kernel, bias) in enumerate(layers)
        }
    }


def array_of_shape(
    arrays: Mapping[str, np.ndarray], name: str, shape: tuple[int, ...]
) -> Float[Array, "..."]:
    """Return a named array as a JAX array.

    Raises:
        ValueError: the array is missing or of another shape.
    """
    if name not in arrays:
        raise ValueError(f"{name} is missing")
    if arrays[name].shape != shape:
        raise ValueError(f"{name} is of shape {arrays[name].shape}, not {shape}")
    return jnp.asarray(arrays[name])
