"""The convolutions and the dense layer that encode one map."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array
from jaxtyping import Float, Key

from jaxleas.training.brax_blocks import ACTIVATION
from jaxleas.training.networks.activations import onnx_activation
from jaxleas.training.networks.mlp import array_of_shape
from jaxleas.types import OnnxNodes

STRIDE = 2


@dataclass(frozen=True)
class MapCode:
    """The encoding of one map [rows, columns] as a vector.

    Attributes:
        shape: rows and columns of the map.
        channels: channels of each convolution.
        kernels: side of each convolution's kernel.
        latent: length of the vector.
        activation: name of the activation.
    """

    shape: tuple[int, int]
    channels: tuple[int, ...]
    kernels: tuple[int, ...]
    latent: int
    activation: str

    @property
    def shapes(self) -> dict[str, tuple[int, ...]]:
        """Shapes of the arrays by name."""
        found: dict[str, tuple[int, ...]] = {}
        before = 1
        for index, (channels, side) in enumerate(zip(self.channels, self.kernels, strict=True)):
            found[f"convolution_{index}"] = (channels, before, side, side)
            found[f"convolution_bias_{index}"] = (channels,)
            before = channels
        rows, columns = self.shape
        for _ in self.channels:
            rows, columns = _halved(rows), _halved(columns)
        found["latent_kernel"] = (before * rows * columns, self.latent)
        found["latent_bias"] = (self.latent,)
        return found

    def init(self, key: Key[Array, ""]) -> dict[str, Array]:
        """Return untrained arrays: LeCun's uniform kernels, biases of zero."""
        shapes, arrays = self.shapes, {}
        for part_key, (name, size) in zip(
            jax.random.split(key, len(shapes)), shapes.items(), strict=True
        ):
            if "bias" in name:
                arrays[name] = jnp.zeros(size)
            else:
                fan_in = size[0] if len(size) == 2 else size[1] * size[2] * size[3]
                bound = (3.0 / fan_in) ** 0.5
                arrays[name] = jax.random.uniform(part_key, size, minval=-bound, maxval=bound)
        return arrays

    def encode(self, arrays: Any, rows: Float[Array, "*batch cells"]) -> Array:
        """Return the vectors of maps, each given row by row."""
        activate = ACTIVATION[self.activation]
        image = rows.reshape(-1, 1, *self.shape)
        for index, side in enumerate(self.kernels):
            kernel = arrays[f"convolution_{index}"].astype(image.dtype)
            padding = [_padding(length, side) for length in image.shape[2:]]
            image = jax.lax.conv_general_dilated(image, kernel, (STRIDE, STRIDE), padding)
            bias = arrays[f"convolution_bias_{index}"].astype(image.dtype)
            image = activate(image + bias.reshape(1, -1, 1, 1))
        flat = image.reshape(image.shape[0], -1)
        latent = flat @ arrays["latent_kernel"].astype(flat.dtype)
        latent = activate(latent + arrays["latent_bias"].astype(flat.dtype).reshape(1, -1))
        return latent.reshape(*rows.shape[:-1], self.latent)

    def parameters(self, arrays: Mapping[str, np.ndarray], prefix: str) -> dict[str, Array]:
        """Return the arrays that a file holds under names with a prefix."""
        return {
            name: array_of_shape(arrays, f"{prefix}{name}", size)
            for name, size in self.shapes.items()
        }

    def onnx(self, nodes: OnnxNodes, arrays: Any, rows: str) -> str:
        """Add Conv nodes, and return the name of the vectors."""
        image = nodes.add("Reshape", rows, nodes.constant([-1, 1, *self.shape], np.int64))
        height, width = self.shape
        for index, side in enumerate(self.kernels):
            (top, bottom), (left, right) = _padding(height, side), _padding(width, side)
            image = nodes.add(
                "Conv",
                image,
                nodes.constant(arrays[f"convolution_{index}"]),
                nodes.constant(arrays[f"convolution_bias_{index}"]),
                strides=[STRIDE, STRIDE],
                pads=[top, left, bottom, right],
            )
            image = onnx_activation(nodes, self.activation, image)
            height, width = _halved(height), _halved(width)
        kernel, bias = (nodes.constant(arrays[f"latent_{name}"]) for name in ("kernel", "bias"))
        latent = nodes.add("Gemm", nodes.add("Flatten", image, axis=1), kernel, bias)
        return onnx_activation(nodes, self.activation, latent)


def _halved(length: int) -> int:
    """Return the length of an axis after a convolution: half, rounded up."""
    return -(-length // STRIDE)


def _padding(length: int, side: int) -> tuple[int, int]:
    """Return the zeros before and after an axis that make it ceil(length / 2) long."""
    total = max((_halved(length) - 1) * STRIDE + side - length, 0)
    return total // 2, total - total // 2
