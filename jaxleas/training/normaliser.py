"""From physical units to what networks see: fixed by the task's bounds, or running statistics."""

import jax.numpy as jnp
from jax import Array
from jaxtyping import Float

from jaxleas.envs import Signature
from jaxleas.training.brax_blocks import running_statistics, specs
from jaxleas.training.config import NetworkConfig

# A constant input has no deviation: without floor and clip it explodes when it first moves.
MIN_DEVIATION = 1e-2
MAX_NORMALISED = 10.0

Normaliser = running_statistics.NestedMeanStd


def normalise(observation: Float[Array, "*batch size"], normaliser: Normaliser) -> Array:
    """Return (observation - mean) / deviation, clipped to [-10, 10]."""
    return running_statistics.normalize(observation, normaliser, max_abs_value=MAX_NORMALISED)


def initial_normaliser(config: NetworkConfig, signature: Signature) -> Normaliser:
    """Return the normaliser before any data."""
    if config.normaliser == "running":
        return running_statistics.init_state(specs.Array((signature.size,), jnp.dtype("float32")))
    mean, deviation = signature.scaling
    return running_statistics.NestedMeanStd(mean=jnp.asarray(mean), std=jnp.asarray(deviation))


def update_normaliser(
    normaliser: Normaliser, observation: Float[Array, "*batch size"]
) -> Normaliser:
    """Return the normaliser after seeing a batch: only running statistics change."""
    if isinstance(normaliser, running_statistics.RunningStatisticsState):
        return running_statistics.update(
            normaliser, observation, std_min_value=MIN_DEVIATION, std_max_value=1e6
        )
    return normaliser
