"""Activations by name, in JAX and as ONNX nodes."""

from typing import Literal

from jaxleas.training.brax_blocks import ACTIVATION
from jaxleas.types import InputError, OnnxNodes

Activation = Literal["relu", "tanh", "swish", "elu"]
ACTIVATIONS = {name: ACTIVATION[name] for name in ("relu", "tanh", "swish", "elu")}


def onnx_activation(nodes: OnnxNodes, name: str, value: str) -> str:
    """Add the nodes of an activation; return the name of its result.

    Raises:
        InputError: ONNX has no counterpart of the activation.
    """
    match name:
        case "relu":
            return nodes.add("Relu", value)
        case "tanh":
            return nodes.add("Tanh", value)
        case "elu":
            return nodes.add("Elu", value, alpha=1.0)
        case "swish":
            return nodes.add("Mul", value, nodes.add("Sigmoid", value))
        case other:
            raise InputError(f"the activation {other!r} cannot be exported to ONNX")
