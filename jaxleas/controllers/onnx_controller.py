"""A policy in an ONNX file as a walking controller."""

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from jaxtyping import Float

from jaxleas.controllers.controller import JointCommand
from jaxleas.controllers.policy_description import read_description
from jaxleas.files import digest_of, read_bytes
from jaxleas.physics import FREE_JOINT, ROOT_SPEEDS, Body, BodyState, Sensed
from jaxleas.types import InputError

MAX_BYTES = 2**28  # a policy of a quarter of a gigabyte is a mistake


@dataclass(frozen=True, eq=False)
class PolicyMemory:
    """What the adapter remembers of N robots.

    Attributes:
        action: the policy's last output.
        begun: time at which it began to walk [s].
    """

    action: Float[np.ndarray, "N J"]
    begun: Float[np.ndarray, " N"]


class OnnxController:
    """A policy that draws the joints to angles: standing + scale x output.

    The JSON file beside it, of the same name, says what its numbers mean (`PolicyDescription`).

    Attributes:
        identity: what its footsteps and models are those of.
        period: time between two decisions [s].
    """

    def __init__(self, path: str | Path, body: Body) -> None:
        import onnxruntime

        self._path = Path(path)
        content = read_bytes(self._path, MAX_BYTES)
        self._description = read_description(self._path.with_suffix(".json"), body)
        self.identity = self._description.identity(self._path.stem, body, digest_of(self._path))
        self.period = self._description.period
        order = np.array(self._description.order(body))
        self._columns = np.concatenate([np.arange(FREE_JOINT), FREE_JOINT + order])
        self._speeds = np.concatenate([np.arange(ROOT_SPEEDS), ROOT_SPEEDS + order])
        self._back = np.argsort(order)
        options = onnxruntime.SessionOptions()
        options.log_severity_level = 4
        options.intra_op_num_threads = 1
        try:
            self._session = onnxruntime.InferenceSession(
                content, options, providers=["CPUExecutionProvider"]
            )
        except Exception as error:  # onnxruntime's exceptions have no common base
            raise InputError(f"{path} is no ONNX policy: {_reason(error)}") from error
        if (len(self._session.get_inputs()), len(self._session.get_outputs())) != (1, 1):
            raise InputError(f"{path}: a walking policy has one input and one output")

    def start(self, state: BodyState) -> PolicyMemory:
        """Return the memory of robots that stand at rest."""
        return PolicyMemory(np.zeros_like(state.angles), state.time.copy())

    def act(
        self,
        memory: PolicyMemory,
        state: BodyState,
        sensed: Sensed,
        command: Float[np.ndarray, "N 3"],
    ) -> tuple[PolicyMemory, JointCommand]:
        """Return the next memory, and the angles that the joints are drawn to."""
        del sensed
        described = self._description
        seen = replace(
            state,
            coordinates=state.coordinates[:, self._columns],
            speeds=state.speeds[:, self._speeds],
        )
        time = state.time - memory.begun
        observation = described.observe(seen, command, memory.action, time).astype(np.float32)
        action = self._run(observation).astype(np.float64)
        targets = np.array(described.standing) + described.action_scale * action
        wanted = JointCommand(
            np.zeros_like(targets), targets[:, self._back], described.stiffness, described.damping
        )
        return PolicyMemory(action, memory.begun), wanted

    def _run(self, observation: np.ndarray) -> np.ndarray:
        (given,) = self._session.get_inputs()
        try:
            (action,) = self._session.run(None, {given.name: observation})
        except Exception as error:  # onnxruntime's exceptions have no common base
            raise InputError(
                f"{self._path} cannot be run on observations of {observation.shape[1]} numbers:"
                f" {_reason(error)}"
            ) from error
        wanted = (len(observation), len(self._back))
        shape = getattr(action, "shape", type(action).__name__)
        if not isinstance(action, np.ndarray) or shape != wanted:
            raise InputError(f"{self._path} answers with {shape}; {wanted} is needed")
        return action


def _reason(error: Exception) -> str:
    return (str(error) or type(error).__name__).splitlines()[0]
