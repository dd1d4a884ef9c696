"""The nodes of an ONNX graph, in the order of computation."""

from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    import onnx


class OnnxNodes:
    """Nodes and constants of a graph; each method returns the name of its result.

    Attributes:
        nodes: operators added so far, each after those whose results it takes.
        constants: constants of the graph.
    """

    def __init__(self) -> None:
        self.nodes: list[onnx.NodeProto] = []
        self.constants: list[onnx.TensorProto] = []

    def constant(self, value: object, kind: type = np.float32) -> str:
        """Add a constant.

        Args:
            value: number or array.
            kind: type of the elements.
        """
        import onnx

        name = f"constant_{len(self.constants)}"
        self.constants.append(onnx.numpy_helper.from_array(np.asarray(value, kind), name))
        return name

    def add(self, operator: str, *inputs: str, output: str = "", **attributes: Any) -> str:
        """Add one node.

        Args:
            operator: name of the ONNX operator.
            inputs: names of the operator's inputs.
            output: name of the result; by default a new name.
            attributes: attributes of the operator.
        """
        import onnx

        output = output or f"{operator.lower()}_{len(self.nodes)}"
        self.nodes.append(onnx.helper.make_node(operator, inputs, [output], **attributes))
        return output

    def columns(self, value: str, first: int, last: int) -> str:
        """Add a slice: columns first to last - 1 of a table [batch, columns]."""
        ends = [self.constant([end], np.int64) for end in (first, last)]
        return self.add("Slice", value, *ends, self.constant([1], np.int64))
