"""Comparison of the artifacts with the policy, on observations that a robot really makes."""

from collections.abc import Callable
from typing import Any

import jax
import numpy as np
from jaxtyping import Float

from jaxleas.envs import Cases, Categorical, Head
from jaxleas.export.errors import ExportError
from jaxleas.export.recording import LEAST_OBSERVATIONS
from jaxleas.export.stablehlo import stablehlo_from_bytes
from jaxleas.training import Policy

TOLERANCE = 1e-5  # per number of a command, in its unit; relative to its range if beyond 1
_MOST_TIES = 1e-3  # share of choices that may differ: two may be equally likely within rounding


def largest_difference(
    policy: Policy,
    onnx_file: bytes,
    stablehlo: bytes,
    observations: Float[np.ndarray, "count seen"],
) -> dict[str, float]:
    """Return the differences between the artifacts and JAX on these observations.

    Args:
        policy: policy as JAX computes it.
        onnx_file: content of the ONNX file, which onnxruntime runs.
        stablehlo: serialised StableHLO.
        observations: observations in physical units, at least 10,000.

    Returns:
        The largest absolute difference of each artifact, in the commands' units; for choices, the
        share that differs.

    Raises:
        ExportError: there are too few observations, or a difference is above `TOLERANCE`.
    """
    observations = np.asarray(observations, np.float32)
    if len(observations) < LEAST_OBSERVATIONS:
        raise ExportError(
            f"the artifacts must be compared on at least {LEAST_OBSERVATIONS} observations, not"
            f" on {len(observations)}; nothing was written"
        )
    shown = _by_part(policy, observations)
    with jax.default_matmul_precision("highest"):  # as the artifacts compute, on any device
        expected = _by_head(policy, jax.jit(policy.__call__)(_given(shown)))
    artifacts: dict[str, Callable[[dict[str, np.ndarray]], Any]] = {
        "onnxruntime": lambda shown: _run_onnx(onnx_file, policy, shown),
        "stablehlo": lambda shown: stablehlo_from_bytes(stablehlo)(_given(shown)),
    }
    differences, heads = {}, policy.signature.heads
    for name, artifact in artifacts.items():
        found = _by_head(policy, artifact(shown))
        gap = max(_gap(head, found[head.name], expected[head.name]) for head in heads)
        if not gap <= TOLERANCE:  # a NaN is a difference too
            raise ExportError(
                f"{name} and JAX differ by {gap:.3g} on {len(observations)} recorded observations,"
                f" more than {TOLERANCE:g}; nothing was written"
            )
        differences[name] = gap
    return differences


def _gap(head: Head, found: np.ndarray, expected: np.ndarray) -> float:
    """Return the difference of a head's commands; few choices may differ, and their numbers."""
    if isinstance(head, Categorical | Cases):
        one, other = (each.reshape(len(each), -1)[:, -1] for each in (found, expected))
        share = float(np.mean(one != other))
        if share > _MOST_TIES:
            return share
        found, expected = found[one == other], expected[one == other]
    scale = max(1.0, float(np.max(np.abs(expected), initial=0.0)))
    return float(np.max(np.abs(found - expected))) / scale


def _by_part(policy: Policy, observations: np.ndarray) -> dict[str, np.ndarray]:
    ends = np.cumsum([part.size for part in policy.signature.seen])
    return {
        part.name: observations[:, end - part.size : end].reshape(-1, *part.shape)
        for part, end in zip(policy.signature.seen, ends, strict=True)
    }


def _given(shown: dict[str, np.ndarray]) -> Any:
    return next(iter(shown.values())) if len(shown) == 1 else shown


def _by_head(policy: Policy, command: Any) -> dict[str, np.ndarray]:
    heads = policy.signature.heads
    if not isinstance(command, dict):
        command = {heads[0].name: command}
    return {head.name: np.asarray(command[head.name]) for head in heads}


def _run_onnx(content: bytes, policy: Policy, shown: dict[str, np.ndarray]) -> dict[str, Any]:
    import onnxruntime

    options = onnxruntime.SessionOptions()
    options.intra_op_num_threads = options.inter_op_num_threads = 1
    session = onnxruntime.InferenceSession(content, options, providers=["CPUExecutionProvider"])
    names = [head.name for head in policy.signature.heads]
    return dict(zip(names, session.run(names, shown), strict=True))
