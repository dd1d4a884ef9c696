"""A proposal as an ONNX graph, and run by onnxruntime in one thread."""

import numpy as np
from jaxtyping import Float

from jaxleas.footsteps.proposal import Proposal
from jaxleas.footsteps.proposal_inputs import ProposalInputs
from jaxleas.types import OnnxNodes

OPSET = 17
IR_VERSION = 8  # the version that goes with opset 17: every runtime since 2022 reads it


def build_proposal_onnx(proposal: Proposal) -> bytes:
    """Return a proposal as the content of an ONNX file, checked by onnx itself.

    Its inputs are `commands` [commands, P] and `state` [1, Q], float32; its output is `score`
    [commands, 1]. The number of commands is dynamic.
    """
    import onnx

    helper, kind = onnx.helper, onnx.TensorProto.FLOAT
    nodes = OnnxNodes()
    weights = [nodes.constant(each) for each in (proposal.of_command, proposal.of_state)]
    of_state = nodes.add("Gemm", "state", weights[1], nodes.constant(proposal.bias[None]))
    first = nodes.add("Relu", nodes.add("Gemm", "commands", weights[0], of_state))
    hidden = [nodes.constant(each) for each in (proposal.hidden, proposal.hidden_bias)]
    second = nodes.add("Relu", nodes.add("Gemm", first, *hidden))
    nodes.add("MatMul", second, nodes.constant(proposal.last[:, None]), output="score")
    inputs = [
        helper.make_tensor_value_info("commands", kind, ["commands", len(proposal.of_command)]),
        helper.make_tensor_value_info("state", kind, [1, len(proposal.of_state)]),
    ]
    model = helper.make_model(
        helper.make_graph(
            nodes.nodes,
            "proposal",
            inputs,
            [helper.make_tensor_value_info("score", kind, ["commands", 1])],
            nodes.constants,
        ),
        opset_imports=[helper.make_opsetid("", OPSET)],
        ir_version=IR_VERSION,
        producer_name="jaxleas",
        doc_string=f"Scores of commands for {proposal.controller.name}.",
    )
    known = {"controller": proposal.controller.name, "robot": proposal.controller.robot}
    helper.set_model_props(model, {**known, "motion": proposal.motion})
    onnx.checker.check_model(model, full_check=True)
    return model.SerializeToString()


class ProposalSession:
    """A proposal run by onnxruntime.

    Args:
        proposal: proposal to run.
    """

    def __init__(self, proposal: Proposal) -> None:
        import onnxruntime

        options = onnxruntime.SessionOptions()
        options.log_severity_level = 4
        options.intra_op_num_threads = options.inter_op_num_threads = 1
        self._session = onnxruntime.InferenceSession(
            build_proposal_onnx(proposal), options, providers=["CPUExecutionProvider"]
        )

    def scores(self, inputs: ProposalInputs) -> Float[np.ndarray, " C"]:
        """Return the score of each command."""
        given = {"commands": inputs.commands, "state": inputs.state[None]}
        return np.asarray(self._session.run(["score"], given)[0])[:, 0]
