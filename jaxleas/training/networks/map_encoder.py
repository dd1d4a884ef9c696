"""A network with an encoder for each map: convolutions and a dense layer, joined with the vectors.

D sec. III-A: three convolutions and a dense layer per map; their output is joined with the other
parts of the observation and goes through a perceptron.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array
from jaxtyping import Float, Key

from jaxleas.envs import Part
from jaxleas.training.networks.map_code import MapCode
from jaxleas.training.networks.mlp import Mlp, layers_of, params_of
from jaxleas.types import OnnxNodes


@dataclass(frozen=True)
class MapEncoder:
    """Convolutions of stride 2 over each map, a dense layer, and a perceptron over everything.

    Attributes:
        shapes: shape of each part of the input; parts with two axes are maps.
        channels: channels of each convolution.
        kernels: side of each convolution's kernel.
        latent: length of the vector into which each map is encoded.
        hidden: sizes of the perceptron's layers.
        outputs: length of the answer.
        activation: name of the activation.
    """

    shapes: tuple[tuple[int, ...], ...]
    channels: tuple[int, ...]
    kernels: tuple[int, ...]
    latent: int
    hidden: tuple[int, ...]
    outputs: int
    activation: str

    @classmethod
    def over(cls, parts: tuple[Part, ...], **sizes: Any) -> "MapEncoder":
        """Return the network over some parts of an observation."""
        return cls(tuple(part.shape for part in parts), **sizes)

    @property
    def inputs(self) -> int:
        """Length of the input."""
        return sum(_size(shape) for shape in self.shapes)

    @property
    def _maps(self) -> list[tuple[int, MapCode]]:
        """Position in the input at which each map begins, and its encoder."""
        begin, found = 0, []
        for shape in self.shapes:
            if len(shape) == 2:
                sizes = (self.channels, self.kernels, self.latent, self.activation)
                found.append((begin, MapCode((shape[0], shape[1]), *sizes)))
            begin += _size(shape)
        return found

    @property
    def _joined(self) -> Mlp:
        vectors = sum(_size(shape) for shape in self.shapes if len(shape) != 2)
        inputs = vectors + self.latent * len(self._maps)
        return Mlp(inputs, self.hidden, self.outputs, self.activation)

    def init(self, key: Key[Array, ""]) -> Any:
        """Return untrained parameters: LeCun's uniform kernels, biases of zero."""
        joined_key, *keys = jax.random.split(key, 1 + len(self._maps))
        encoders = [encoder.init(each) for each, (_, encoder) in zip(keys, self._maps, strict=True)]
        return {"maps": encoders, **self._joined.init(joined_key)}

    def answer(
        self,
        params: Any,
        rows: Float[Array, "*batch inputs"],
        numbers: str = "float32",
    ) -> Float[Array, "*batch outputs"]:
        """Return the answer as training computes it (`Network.answer`)."""
        joined = self._encode(params, rows.astype(numbers))
        return self._joined.answer(params, joined, numbers)

    def plain(
        self, params: Any, rows: Float[Array, "*batch inputs"]
    ) -> Float[Array, "*batch outputs"]:
        """Return the answer as it is judged."""
        return self._joined.plain(params, self._encode(params, rows))

    def _encode(self, params: Any, rows: Array) -> Array:
        """Return the vectors, then the encoding of each map."""
        latents = [
            encoder.encode(arrays, rows[..., begin : begin + _size(encoder.shape)])
            for arrays, (begin, encoder) in zip(params["maps"], self._maps, strict=True)
        ]
        return jnp.concatenate([*self._vectors(rows), *latents], axis=-1)

    def _vectors(self, rows: Array) -> list[Array]:
        begin, found = 0, []
        for shape in self.shapes:
            if len(shape) != 2:
                found.append(rows[..., begin : begin + _size(shape)])
            begin += _size(shape)
        return found

    def arrays(self, params: Any) -> dict[str, Array]:
        """Return map_0_convolution_0 and so on, then the perceptron's kernel_0 and so on."""
        found = {
            f"map_{number}_{name}": array
            for number, arrays in enumerate(params["maps"])
            for name, array in arrays.items()
        }
        return found | self._joined.arrays(params)

    def parameters(self, arrays: Mapping[str, np.ndarray]) -> Any:
        """Return the parameters that `arrays` turned into named arrays."""
        encoders = [
            encoder.parameters(arrays, f"map_{number}_")
            for number, (_, encoder) in enumerate(self._maps)
        ]
        joined = layers_of(self._joined.parameters(arrays))
        return {"maps": encoders, **params_of(joined)}

    def onnx(self, nodes: OnnxNodes, params: Any, rows: str) -> str:
        """Add Conv nodes for each map, and the perceptron over everything."""
        joined, latents, begin = [], [], 0
        encoders = iter(zip(params["maps"], self._maps, strict=True))
        for shape in self.shapes:
            part = nodes.columns(rows, begin, begin + _size(shape))
            begin += _size(shape)
            if len(shape) == 2:
                weights, (_, encoder) = next(encoders)
                latents.append(encoder.onnx(nodes, weights, part))
            else:
                joined.append(part)
        return self._joined.onnx(nodes, params, nodes.add("Concat", *joined, *latents, axis=1))

    def describe(self) -> dict[str, Any]:
        """Return the kind and sizes of the network."""
        return {
            "kind": "maps",
            "hidden": list(self.hidden),
            "channels": list(self.channels),
            "kernels": list(self.kernels),
            "latent": self.latent,
        }


def _size(shape: tuple[int, ...]) -> int:
    return int(np.prod(shape))
