"""What an untrusted graph may contain: arithmetic on weights that are inside the file."""

from typing import TYPE_CHECKING

from jaxleas.types import InputError

if TYPE_CHECKING:
    import onnx

OPERATORS = frozenset(
    (
        *("Abs", "Add", "BatchNormalization", "Cast", "Clip", "Concat", "Constant", "Div", "Elu"),
        *("Exp", "Flatten", "Gather", "Gelu", "Gemm", "HardSigmoid", "HardSwish", "Identity"),
        *("LayerNormalization", "LeakyRelu", "MatMul", "Max", "Mean", "Min", "Mish", "Mul", "Neg"),
        *("PRelu", "Pow", "Reciprocal", "ReduceL2", "ReduceMax", "ReduceMean", "ReduceMin"),
        *("ReduceSum", "Relu", "Reshape", "Selu", "Sigmoid", "Sin", "Cos", "Slice", "Softmax"),
        *("Softplus", "Softsign", "Split", "Sqrt", "Squeeze", "Sub", "Sum", "Tanh", "Transpose"),
        *("Unsqueeze", "Where"),
    )
)
"""No operator loops, makes an array larger than its inputs, or reads a file."""
MAX_NODES = 10_000
MAX_ELEMENTS = 2**26


def require_plain_graph(model: "onnx.ModelProto", path: object) -> None:
    """Refuse a model that may read other files, loop, or take memory beyond its own size.

    Args:
        model: model as parsed, not yet checked by onnx.
        path: path of the file, for messages.

    Raises:
        InputError: the model contains something that no policy needs; the message says what.
    """
    graph = model.graph
    if model.functions or model.training_info or graph.sparse_initializer:
        raise InputError(f"{path} defines functions, training or sparse weights; no policy does")
    if len(graph.node) > MAX_NODES:
        raise InputError(f"{path} has {len(graph.node)} nodes, more than the {MAX_NODES} accepted")
    tensors = list(graph.initializer)
    for node in graph.node:
        if node.op_type not in OPERATORS:
            raise InputError(
                f"{path} uses the operator {node.op_type!a}, which no steering policy needs"
            )
        for attribute in node.attribute:
            if attribute.HasField("g") or attribute.graphs or attribute.HasField("sparse_tensor"):
                raise InputError(f"{path} has a graph or sparse weights inside a node")
            tensors += [*attribute.tensors, *([attribute.t] if attribute.HasField("t") else [])]
    for tensor in tensors:
        _require_inside(tensor, path)


def _require_inside(tensor: "onnx.TensorProto", path: object) -> None:
    import onnx

    if tensor.data_location == onnx.TensorProto.EXTERNAL or tensor.external_data:
        raise InputError(f"{path} keeps weights in other files; they must be inside")
    elements = 1
    for size in tensor.dims:
        elements *= size
        if size < 0 or elements > MAX_ELEMENTS:
            raise InputError(f"{path} has weights of shape {list(tensor.dims)[:8]}")
