"""A policy as StableHLO: for JAX and XLA programs that have no jaxleas."""

from collections.abc import Callable
from pathlib import Path

import jax
import jax.numpy as jnp
from jax import Array
from jax import export as jax_export

from jaxleas.envs.steering.layout import layout_named
from jaxleas.training.policy import SteeringPolicy
from jaxleas.types import InputError

PLATFORMS = ("cpu", "cuda", "tpu")


def to_stablehlo(policy: SteeringPolicy) -> bytes:
    """Return a policy, weights inside, as serialised StableHLO with a symbolic batch.

    Args:
        policy: to be exported; `observation` [batch, size] to `command` [batch, 4], float32.
    """
    size = layout_named(policy.config.observation).size
    (batch,) = jax_export.symbolic_shape("batch")
    observation = jax.ShapeDtypeStruct((batch, size), jnp.float32)
    # The default lets accelerators round products to ten bits: no artifact to compare with others.
    with jax.default_matmul_precision("highest"):
        exported = jax_export.export(jax.jit(policy.__call__), platforms=PLATFORMS)(observation)
    return bytes(exported.serialize())


def read_stablehlo(path: str | Path) -> Callable[[Array], Array]:
    """Return the policy in a .stablehlo file: observation [batch, size] to command [batch, 4].

    Raises:
        InputError: the file is missing or not a serialised export.
    """
    try:
        return stablehlo_from_bytes(Path(path).read_bytes())
    except OSError as error:
        raise InputError(f"cannot read {path}: {error.strerror or error}") from error
    except Exception as error:  # flatbuffers and jax raise whatever they stumble over
        raise InputError(f"{path} is not a StableHLO policy: {error}") from error


def stablehlo_from_bytes(content: bytes) -> Callable[[Array], Array]:
    """Return the function that `to_stablehlo` serialised."""
    return jax_export.deserialize(bytearray(content)).call
