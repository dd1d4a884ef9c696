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
from jaxleas.training.brax_blocks import ACTIVATION
from jaxleas.training.networks.activations import onnx_activation
from jaxleas.training.networks.mlp import Mlp, array_of_shape, layers_of, params_of
from jaxleas.types import OnnxNodes

STRIDE = 2


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
    def _maps(self) -> list[tuple[int, tuple[int, int]]]:
        """Position in the input at which each map begins, and its shape."""
        begin, found = 0, []
        for shape in self.shapes:
            if len(shape) == 2:
                found.append((begin, (shape[0], shape[1])))
            begin += _size(shape)
        return found

    @property
    def _joined(self) -> Mlp:
        vectors = sum(_size(shape) for shape in self.shapes if len(shape) != 2)
        inputs = vectors + self.latent * len(self._maps)
        return Mlp(inputs, self.hidden, self.outputs, self.activation)

    def _sizes(self, shape: tuple[int, int]) -> tuple[int, int]:
        """Return rows and columns after the convolutions: each halves them, rounding up."""
        rows, columns = shape
        for _ in self.channels:
            rows, columns = -(-rows // STRIDE), -(-columns // STRIDE)
        return rows, columns

    def _shapes(self, shape: tuple[int, int]) -> dict[str, tuple[int, ...]]:
        """Return the shapes of an encoder's arrays by name."""
        found: dict[str, tuple[int, ...]] = {}
        before = 1
        for index, (channels, side) in enumerate(zip(self.channels, self.kernels, strict=True)):
            found[f"convolution_{index}"] = (channels, before, side, side)
            found[f"convolution_bias_{index}"] = (channels,)
            before = channels
        rows, columns = self._sizes(shape)
        found["latent_kernel"] = (before * rows * columns, self.latent)
        found["latent_bias"] = (self.latent,)
        return found

    def init(self, key: Key[Array, ""]) -> Any:
        """Return untrained parameters: LeCun's uniform kernels, biases of zero."""
        joined_key, *keys = jax.random.split(key, 1 + len(self._maps))
        encoders = []
        for each, (_, shape) in zip(keys, self._maps, strict=True):
            shapes = self._shapes(shape)
            arrays = {}
            for part_key, (name, size) in zip(
                jax.random.split(each, len(shapes)), shapes.items(), strict=True
            ):
                if "bias" in name:
                    arrays[name] = jnp.zeros(size)
                else:
                    fan_in = size[0] if len(size) == 2 else size[1] * size[2] * size[3]
                    bound = (3.0 / fan_in) ** 0.5
                    arrays[name] = jax.random.uniform(part_key, size, minval=-bound, maxval=bound)
            encoders.append(arrays)
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
        batch = rows.shape[:-1]
        activate = ACTIVATION[self.activation]
        latents = []
        for arrays, (begin, shape) in zip(params["maps"], self._maps, strict=True):
            image = rows[..., begin : begin + _size(shape)].reshape(-1, 1, *shape)
            for index, side in enumerate(self.kernels):
                kernel = arrays[f"convolution_{index}"].astype(image.dtype)
                padding = [_padding(length, side) for length in image.shape[2:]]
                image = jax.lax.conv_general_dilated(image, kernel, (STRIDE, STRIDE), padding)
                bias = arrays[f"convolution_bias_{index}"].astype(image.dtype)
                image = activate(image + bias.reshape(1, -1, 1, 1))
            flat = image.reshape(image.shape[0], -1)
            latent = flat @ arrays["latent_kernel"].astype(flat.dtype)
            latent = activate(latent + arrays["latent_bias"].astype(flat.dtype).reshape(1, -1))
            latents.append(latent.reshape(*batch, self.latent))
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
            {
                name: array_of_shape(arrays, f"map_{number}_{name}", size)
                for name, size in self._shapes(shape).items()
            }
            for number, (_, shape) in enumerate(self._maps)
        ]
        joined = layers_of(self._joined.parameters(arrays))
        return {"maps": encoders, **params_of(joined)}

    def onnx(self, nodes: OnnxNodes, params: Any, rows: str) -> str:
        """Add Conv nodes for each map, and the perceptron over everything."""
        joined, latents, begin = [], [], 0
        encoders = iter(params["maps"])
        for shape in self.shapes:
            part = nodes.columns(rows, begin, begin + _size(shape))
            begin += _size(shape)
            if len(shape) == 2:
                latents.append(self._onnx_map(nodes, next(encoders), (shape[0], shape[1]), part))
            else:
                joined.append(part)
        return self._joined.onnx(nodes, params, nodes.add("Concat", *joined, *latents, axis=1))

    def _onnx_map(self, nodes: OnnxNodes, arrays: Any, shape: tuple[int, int], part: str) -> str:
        image = nodes.add("Reshape", part, nodes.constant([-1, 1, *shape], np.int64))
        rows, columns = shape
        for index, side in enumerate(self.kernels):
            (top, bottom), (left, right) = _padding(rows, side), _padding(columns, side)
            image = nodes.add(
                "Conv",
                image,
                nodes.constant(arrays[f"convolution_{index}"]),
                nodes.constant(arrays[f"convolution_bias_{index}"]),
                strides=[STRIDE, STRIDE],
                pads=[top, left, bottom, right],
            )
            image = onnx_activation(nodes, self.activation, image)
            rows, columns = -(-rows // STRIDE), -(-columns // STRIDE)
        kernel, bias = (nodes.constant(arrays[f"latent_{name}"]) for name in ("kernel", "bias"))
        latent = nodes.add("Gemm", nodes.add("Flatten", image, axis=1), kernel, bias)
        return onnx_activation(nodes, self.activation, latent)

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


def _padding(length: int, side: int) -> tuple[int, int]:
    """Return the zeros before and after an axis that make it ceil(length / 2) long."""
    total = max((-(-length // STRIDE) - 1) * STRIDE + side - length, 0)
    return total // 2, total - total // 2
