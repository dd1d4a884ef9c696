"""Export a policy: build the artifacts, compare them with JAX, and only then write them."""

import hashlib
import json
from collections.abc import Mapping
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float

from jaxleas.envs import TaskConfig
from jaxleas.export.onnx_file import OPSET, build_onnx
from jaxleas.export.parity import TOLERANCE, largest_difference
from jaxleas.export.stablehlo import PLATFORMS, to_stablehlo
from jaxleas.files import write_bytes, write_json
from jaxleas.training import Policy

VERSION = 1  # format of export.json


def export_policy(
    policy: Policy,
    out: str | Path,
    observations: Float[np.ndarray, "count size"],
    config_text: str = "",
    success_table: Any = None,
) -> dict[str, Any]:
    """Write `policy.onnx`, `policy.stablehlo` and `export.json` into a folder, verified.

    Args:
        policy: policy to export.
        out: folder for the artifacts.
        observations: observations recorded from roll-outs, at least 10,000
            (`record_observations`).
        config_text: training configuration as YAML.
        success_table: measured success of the policy, any JSON value.

    Returns:
        The content of `export.json`.

    Raises:
        ExportError: an artifact differs from JAX by more than 1e-5; nothing is written then.
        InputError: the folder cannot be written.
    """
    metadata = {
        **described(policy.config),
        "jaxleas": json.dumps(version("jaxleas")),
        "training_config": json.dumps(config_text),
        "success": json.dumps(success_table, allow_nan=False),
    }
    stablehlo = to_stablehlo(policy)
    differences = largest_difference(policy, build_onnx(policy, metadata), stablehlo, observations)
    parity = {"observations": len(observations), "tolerance": TOLERANCE, **differences}
    onnx_file = build_onnx(policy, {**metadata, "parity": json.dumps(parity)})
    record = {
        "version": VERSION,
        "jaxleas": version("jaxleas"),
        "parity": parity,
        "policy.onnx": _file(onnx_file, {"opset": OPSET}),
        "policy.stablehlo": _file(stablehlo, {"platforms": list(PLATFORMS)}),
        "metadata": _texts(metadata),
    }
    out = Path(out)
    write_bytes(out / "policy.onnx", onnx_file)
    write_bytes(out / "policy.stablehlo", stablehlo)
    write_json(out / "export.json", record)  # last: it holds the hashes of the other two
    return record


def described(config: TaskConfig) -> dict[str, str]:
    """Return the description in an exported policy of a task, each value as JSON text."""
    return {key: json.dumps(value) for key, value in config.describe().items()}


def _file(content: bytes, facts: Mapping[str, Any]) -> dict[str, Any]:
    return {"bytes": len(content), "sha256": hashlib.sha256(content).hexdigest(), **facts}


def _texts(metadata: Mapping[str, str]) -> dict[str, Any]:
    return {key: json.loads(text) for key, text in metadata.items()}
