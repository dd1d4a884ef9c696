"""A policy as an ONNX graph: physical units in, physical units out, nothing left to its user."""

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from jaxleas.envs.steering.layout import ACTION_SIZE, layout_named
from jaxleas.guide.onnx_metadata import INPUT, OUTPUT
from jaxleas.training.networks import MAX_NORMALISED
from jaxleas.training.policy import SteeringPolicy
from jaxleas.types import InputError

if TYPE_CHECKING:
    import onnx

OPSET = 17
IR_VERSION = 8  # of opset 17's time: read by every runtime since 2022


class _Graph:
    """Nodes in the order in which they compute; each method returns the name of its result."""

    def __init__(self) -> None:
        self.nodes: list[onnx.NodeProto] = []
        self.constants: list[onnx.TensorProto] = []

    def constant(self, value: object, kind: type = np.float32) -> str:
        """Add a constant."""
        import onnx

        name = f"constant_{len(self.constants)}"
        self.constants.append(onnx.numpy_helper.from_array(np.asarray(value, kind), name))
        return name

    def add(self, operator: str, *inputs: str, output: str = "", **attributes: Any) -> str:
        """Add one node."""
        import onnx

        output = output or f"{operator.lower()}_{len(self.nodes)}"
        self.nodes.append(onnx.helper.make_node(operator, inputs, [output], **attributes))
        return output


def build_onnx(policy: SteeringPolicy, metadata: Mapping[str, str]) -> bytes:
    """Return a policy as the content of an ONNX file, checked by onnx itself.

    command = scale(bound(tanh(MLP(clip((observation - mean) / deviation)))))

    Input `observation` [batch, size] and output `command` [batch, 4] are float32 in physical
    units; the batch is dynamic.

    Args:
        policy: to be exported.
        metadata: to be written into the file.

    Raises:
        InputError: the policy's activation has no counterpart in ONNX.
    """
    import onnx

    size = layout_named(policy.config.observation).size
    graph = _Graph()
    _scale(graph, policy, _network(graph, policy, INPUT))
    helper, kind = onnx.helper, onnx.TensorProto.FLOAT
    model = helper.make_model(
        helper.make_graph(
            graph.nodes,
            "steering_policy",
            [helper.make_tensor_value_info(INPUT, kind, ["batch", size])],
            [helper.make_tensor_value_info(OUTPUT, kind, ["batch", ACTION_SIZE])],
            graph.constants,
        ),
        opset_imports=[helper.make_opsetid("", OPSET)],
        ir_version=IR_VERSION,
        producer_name="jaxleas",
        doc_string="LEAS steering policy: local terrain and motion to acceleration and turn rate.",
    )
    helper.set_model_props(model, dict(metadata))
    onnx.checker.check_model(model, full_check=True)
    return model.SerializeToString()


def _network(graph: _Graph, policy: SteeringPolicy, observation: str) -> str:
    """Normalise, clip, apply the layers; return the action in [-1, 1]^4."""
    centred = graph.add("Sub", observation, graph.constant(policy.mean))
    normalised = graph.add("Div", centred, graph.constant(policy.deviation))
    bounds = graph.constant(-MAX_NORMALISED), graph.constant(MAX_NORMALISED)
    hidden = graph.add("Clip", normalised, *bounds)
    layers = list(zip(policy.kernels, policy.biases, strict=True))
    for index, (kernel, bias) in enumerate(layers):
        last = index == len(layers) - 1
        if last:  # the other outputs are exploration's
            kernel, bias = kernel[:, :ACTION_SIZE], bias[:ACTION_SIZE]
        hidden = graph.add("Gemm", hidden, graph.constant(kernel), graph.constant(bias))
        hidden = graph.add("Tanh", hidden) if last else _activate(graph, policy, hidden)
    return hidden


def _activate(graph: _Graph, policy: SteeringPolicy, hidden: str) -> str:
    match policy.activation:
        case "relu":
            return graph.add("Relu", hidden)
        case "tanh":
            return graph.add("Tanh", hidden)
        case "elu":
            return graph.add("Elu", hidden, alpha=1.0)
        case "swish":
            return graph.add("Mul", hidden, graph.add("Sigmoid", hidden))
        case other:
            raise InputError(f"the activation {other!r} cannot be exported to ONNX")


def _scale(graph: _Graph, policy: SteeringPolicy, action: str) -> None:
    """Bound the acceleration's norm by a_max, scale the turn rate by omega_max."""
    limits = policy.limits
    ends = [graph.constant([value], np.int64) for value in (0, 3, ACTION_SIZE)]
    axis = graph.constant([1], np.int64)
    direction = graph.add("Slice", action, ends[0], ends[1], axis)
    turn = graph.add("Slice", action, ends[1], ends[2], axis)
    norm = graph.add("ReduceL2", direction, axes=[1], keepdims=1)
    length = graph.add("Max", norm, graph.constant(1.0))
    bounded = graph.add("Div", direction, length)
    acceleration = graph.add("Mul", bounded, graph.constant(limits.max_acceleration))
    turn_rate = graph.add("Mul", turn, graph.constant(limits.max_turn_rate))
    graph.add("Concat", acceleration, turn_rate, output=OUTPUT, axis=1)
