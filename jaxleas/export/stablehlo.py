"""A policy as StableHLO: for JAX and XLA programs that have no jaxleas."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import jax
import jax.numpy as jnp
from jax import export as jax_export

from jaxleas.training import Policy
from jaxleas.types import InputError

PLATFORMS = ("cpu", "cuda", "tpu")


def to_stablehlo(policy: Policy) -> bytes:
    """Return a policy, weights inside, as serialised StableHLO with a symbolic batch.

    Args:
        policy: policy to export: from parts of the observation [batch, *shape], float32, to heads
            of the action, in physical units; each by name, or the only one alone.
    """
    (batch,) = jax_export.symbolic_shape("batch")
    shown = {
        part.name: jax.ShapeDtypeStruct((batch, *part.shape), jnp.float32)
        for part in policy.signature.seen
    }
    observation = next(iter(shown.values())) if len(shown) == 1 else shown
    # The default lets accelerators round products to ten bits, too coarse to compare artifacts.
    with jax.default_matmul_precision("highest"):
        exported = jax_export.export(jax.jit(policy.__call__), platforms=PLATFORMS)(observation)
    return bytes(exported.serialize())


def read_stablehlo(path: str | Path) -> Callable[[Any], Any]:
    """Return the policy in a .stablehlo file: observation to command, as in `to_stablehlo`.

    Raises:
        InputError: the file is missing or not a serialised export.
    """
    try:
        return stablehlo_from_bytes(Path(path).read_bytes())
    except OSError as error:
        raise InputError(f"cannot read {path}: {error.strerror or error}") from error
    except Exception as error:  # flatbuffers and jax raise exceptions of many kinds
        raise InputError(f"{path} is not a StableHLO policy: {error}") from error


def stablehlo_from_bytes(content: bytes) -> Callable[[Any], Any]:
    """Return the function that `to_stablehlo` serialised."""
    return jax_export.deserialize(bytearray(content)).call
