"""A policy in an ONNX file, run by onnxruntime on the host."""

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal

import jax
import numpy as np
from jax import Array
from jaxtyping import Float

from jaxleas.envs.steering import ACTION_SIZE, SteeringConfig, SteeringEnv, integrate, layout_named
from jaxleas.files import read_bytes
from jaxleas.guide.onnx_graph import require_plain_graph
from jaxleas.guide.onnx_metadata import INPUT, OUTPUT, read_config
from jaxleas.types import InputError, RootMotion

MAX_BYTES = 2**28  # a policy of a quarter of a gigabyte is a mistake
OPSETS = range(13, 24)  # versions of the operator set that onnxruntime can run


@dataclass(frozen=True)
class OnnxPolicy:
    """A map from observation to command, both in physical units, like `Policy`.

    Attributes:
        config: configuration of the environment it was trained in, from the file's metadata.
        metadata: metadata of the file.
    """

    config: SteeringConfig
    metadata: dict[str, str]
    _session: Any = field(repr=False, compare=False)

    def __call__(self, observation: Float[np.ndarray, "*batch size"]) -> np.ndarray:
        """Return acceleration in the root frame [m/s^2] and turn rate [rad/s].

        Raises:
            InputError: the graph fails, or does not return one command per row.
        """
        observation = np.asarray(observation, np.float32)
        flat = observation.reshape(-1, observation.shape[-1])
        try:
            (command,) = self._session.run([OUTPUT], {INPUT: flat})
        except _refusals() as error:
            raise InputError(f"the ONNX policy cannot be run: {_reason(error)}") from error
        if command.shape != (len(flat), ACTION_SIZE):
            raise InputError(f"the ONNX policy answers {len(flat)} rows with {command.shape}")
        return command.reshape(*observation.shape[:-1], ACTION_SIZE)


def read_onnx_policy(path: str | Path) -> OnnxPolicy:
    """Read a policy from an ONNX file that `jaxleas export` wrote.

    Raises:
        InputError: the file is missing, damaged, not a policy, or has another observation layout.
    """
    return onnx_policy_from_bytes(read_bytes(path, MAX_BYTES), path)


def onnx_policy_from_bytes(content: bytes, path: object) -> OnnxPolicy:
    """Return the policy in the content of an ONNX file; `path` is for messages.

    Raises:
        InputError: as `read_onnx_policy`.
    """
    metadata = _read_metadata(content, path)
    config = read_config(path, metadata)
    session = _session(content, path)
    size = layout_named(config.observation).size
    ports = [(each.name, each.type, each.shape[1:]) for each in session.get_inputs()]
    ports += [(each.name, each.type, each.shape[1:]) for each in session.get_outputs()]
    wanted = [(INPUT, "tensor(float)", [size]), (OUTPUT, "tensor(float)", [ACTION_SIZE])]
    if ports != wanted:
        raise InputError(
            f"{path} takes and gives {ports}, where a policy of layout {config.observation} takes"
            f" {INPUT} [batch, {size}] and gives {OUTPUT} [batch, {ACTION_SIZE}], float32"
        )
    return OnnxPolicy(config, metadata, session)


def _read_metadata(content: bytes, path: object) -> dict[str, str]:
    """Check the graph and return the file's metadata."""
    import onnx
    from google.protobuf.message import DecodeError

    try:
        model = onnx.load_model_from_string(content)
        require_plain_graph(model, path)
        onnx.checker.check_model(model, full_check=True)
    except (
        DecodeError,
        onnx.checker.ValidationError,
        onnx.shape_inference.InferenceError,
        UnicodeDecodeError,
        ValueError,
    ) as error:
        raise InputError(f"{path} is not a usable ONNX file: {_reason(error)}") from error
    opsets = {each.domain: each.version for each in model.opset_import}
    if set(opsets) - {"", "ai.onnx"} or opsets.get("", opsets.get("ai.onnx")) not in OPSETS:
        raise InputError(
            f"{path} uses operators {opsets}; standard operators of opset {OPSETS.start} to"
            f" {OPSETS.stop - 1} would do"
        )
    return {each.key: each.value for each in model.metadata_props}


def _reason(error: Exception) -> str:
    """Return the first line of another library's message, for our own sentence."""
    lines = str(error).strip().splitlines() or [type(error).__name__]
    return lines[0].encode(errors="replace").decode()[:200]


def _session(content: bytes, path: object) -> Any:
    import onnxruntime

    options = onnxruntime.SessionOptions()
    options.intra_op_num_threads = options.inter_op_num_threads = 1
    options.log_severity_level = 4  # errors come as exceptions; nothing is printed
    try:
        return onnxruntime.InferenceSession(content, options, providers=["CPUExecutionProvider"])
    except _refusals() as error:
        raise InputError(f"{path} cannot be run by onnxruntime: {_reason(error)}") from error


def _refusals() -> tuple[type[Exception], ...]:
    """Return the exceptions that onnxruntime raises for a model that it cannot load or run."""
    from onnxruntime.capi import onnxruntime_pybind11_state  # type: ignore[attr-defined]

    refusals: Any = onnxruntime_pybind11_state
    return (
        refusals.EPFail,
        refusals.Fail,
        refusals.InvalidArgument,
        refusals.InvalidGraph,
        refusals.InvalidProtobuf,
        refusals.NoSuchFile,
        refusals.NotImplemented,
        refusals.RuntimeException,
        RuntimeError,
        UnicodeDecodeError,
    )


class OnnxLeas:
    """LEAS with the policy of an ONNX file: a steering method that runs on the host."""

    runs_on_host: Literal[True] = True
    guarded: Literal[True] = True

    def __init__(self, env: SteeringEnv, policy: OnnxPolicy):
        self.policy = policy
        limits = env.config.limits
        self._observe = jax.jit(env.observe)
        self._integrate = jax.jit(lambda motion, command: integrate(motion, command, limits))

    def __call__(
        self,
        heights_in_root: Float[Array, "*batch points"],
        motion: RootMotion,
        goal: Float[Array, "*batch 3"],
    ) -> RootMotion:
        """Return the root motion one time step later; the goal's height is ignored."""
        observation = self._observe(heights_in_root, motion, goal[..., :2])
        return self._integrate(motion, self.policy(np.asarray(observation)))
