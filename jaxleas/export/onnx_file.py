"""A policy as an ONNX graph, from physical units to physical units, with nothing left to add."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from jaxleas.envs import Categorical, Head
from jaxleas.training import MAX_NORMALISED, Policy
from jaxleas.types import OnnxNodes

OPSET = 17
IR_VERSION = 8  # the version that goes with opset 17: every runtime since 2022 reads it


def build_onnx(policy: Policy, metadata: Mapping[str, str]) -> bytes:
    """Return a policy as the content of an ONNX file, checked by onnx itself.

    command = scale(mode(network(clip((observation - mean) / deviation))))

    It has an input [batch, *shape] for each part of the observation that the policy is shown, and
    an output for each head of the action: [batch, size] float32 in physical units, or [batch] int64
    for a choice. The batch is dynamic.

    Args:
        policy: policy to export.
        metadata: texts to write into the file, by key.
    """
    import onnx

    helper, kind = onnx.helper, onnx.TensorProto.FLOAT
    signature = policy.signature
    nodes = OnnxNodes()
    logits = policy.network.onnx(nodes, policy.params, _seen(nodes, policy))
    begin = 0
    for head in signature.heads:
        size = sum(head.logits)
        head.onnx(nodes, nodes.columns(logits, begin, begin + size))
        begin += size
    inputs = [
        helper.make_tensor_value_info(part.name, kind, ["batch", *part.shape])
        for part in signature.seen
    ]
    model = helper.make_model(
        helper.make_graph(
            nodes.nodes,
            f"{policy.config.task.replace(':', '_')}_policy",
            inputs,
            [_output(head) for head in signature.heads],
            nodes.constants,
        ),
        opset_imports=[helper.make_opsetid("", OPSET)],
        ir_version=IR_VERSION,
        producer_name="jaxleas",
        doc_string=f"Policy of the task {policy.config.task}: observation to command.",
    )
    helper.set_model_props(model, dict(metadata))
    onnx.checker.check_model(model, full_check=True)
    return model.SerializeToString()


def _output(head: Head) -> Any:
    import onnx

    kinds, info = onnx.TensorProto, onnx.helper.make_tensor_value_info
    if isinstance(head, Categorical):
        return info(head.name, kinds.INT64, ["batch"])
    return info(head.name, kinds.FLOAT, ["batch", head.size])


def _seen(nodes: OnnxNodes, policy: Policy) -> str:
    """Join the parts, normalise and clip; return the name of the network's input."""
    flat = [
        part.name
        if len(part.shape) == 1
        else nodes.add("Reshape", part.name, nodes.constant([-1, part.size], np.int64))
        for part in policy.signature.seen
    ]
    observation = flat[0] if len(flat) == 1 else nodes.add("Concat", *flat, axis=1)
    centred = nodes.add("Sub", observation, nodes.constant(policy.mean))
    normalised = nodes.add("Div", centred, nodes.constant(policy.deviation))
    bounds = nodes.constant(-MAX_NORMALISED), nodes.constant(MAX_NORMALISED)
    return nodes.add("Clip", normalised, *bounds)
