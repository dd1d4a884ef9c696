"""Which network a configuration, or a policy's file, asks for."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from jaxleas.envs import Part
from jaxleas.training.config import NetworkConfig
from jaxleas.training.networks.activations import ACTIVATIONS
from jaxleas.training.networks.map_encoder import MapEncoder
from jaxleas.training.networks.mlp import Mlp
from jaxleas.training.networks.network import Network


def make_network(config: NetworkConfig, parts: tuple[Part, ...], outputs: int) -> Network:
    """Return the network over some parts of an observation.

    Args:
        config: kind and sizes; the kind `maps` gives a perceptron where no part is a map.
        parts: parts of the observation, in the order in which they come.
        outputs: length of the network's answer.
    """
    if config.kind == "maps" and any(part.is_map for part in parts):
        maps = config.maps
        return MapEncoder.over(
            parts,
            channels=maps.channels,
            kernels=maps.kernels,
            latent=maps.latent,
            hidden=config.hidden,
            outputs=outputs,
            activation=config.activation,
        )
    inputs = sum(part.size for part in parts)
    return Mlp(inputs, config.hidden, outputs, config.activation)


def network_described(
    described: Mapping[str, Any] | None,
    activation: str,
    arrays: Mapping[str, np.ndarray],
    parts: tuple[Part, ...],
    outputs: int,
) -> Network:
    """Return the network that a policy's file describes.

    Args:
        described: value that `Network.describe` returned; None in files of policies that were
            written before there was more than one kind.
        activation: name of the activation.
        arrays: parameters of the network, which give the sizes of the layers.
        parts: parts of the observation that the network sees.
        outputs: length of the network's answer.

    Raises:
        ValueError: there is no such kind or activation, or a size is not a number.
    """
    if activation not in ACTIVATIONS:
        raise ValueError(f"activation {activation!r}")
    hidden = _hidden(arrays)
    described = {"kind": "mlp"} if described is None else described
    kind = described["kind"]
    if kind == "mlp":
        return Mlp(sum(part.size for part in parts), hidden, outputs, activation)
    if kind != "maps":
        raise ValueError(f"network.kind {kind!r}; there are mlp, maps")
    sizes = {name: tuple(map(int, described[name])) for name in ("channels", "kernels")}
    if not 0 < len(sizes["channels"]) == len(sizes["kernels"]) <= 16:
        raise ValueError("network.channels and network.kernels must be as long as each other")
    return MapEncoder.over(
        parts,
        **sizes,
        latent=int(described["latent"]),
        hidden=hidden,
        outputs=outputs,
        activation=activation,
    )


def _hidden(arrays: Mapping[str, np.ndarray]) -> tuple[int, ...]:
    """Return the sizes of the hidden layers: the lengths of all biases but the last."""
    count = sum(name.startswith("kernel_") for name in arrays)
    biases = [arrays.get(f"bias_{index}") for index in range(count - 1)]
    return tuple(-1 if bias is None or bias.ndim != 1 else len(bias) for bias in biases)
