"""A trained steering policy by itself: observation in physical units to command in physical units.

This is the value that leaves training: roll-outs, evaluation and export all use it, so what they
judge and ship is one thing. As a file it is plain arrays and one JSON text (`policy.npz`).
"""

import itertools
import json
from pathlib import Path
from typing import Any

import jax.numpy as jnp
import numpy as np
from flax import struct
from jax import Array
from jaxtyping import Float
from pydantic import ValidationError

from jaxleas.envs.steering.config import MotionLimits, SteeringConfig
from jaxleas.envs.steering.env import SteeringEnv
from jaxleas.envs.steering.layout import ACTION_SIZE, layout_named
from jaxleas.envs.steering.motion import scale_action
from jaxleas.files import parse_json, read_npz, write_npz
from jaxleas.training.brax_blocks import ACTIVATION
from jaxleas.training.networks import MAX_NORMALISED, Normaliser
from jaxleas.types import InputError

FORMAT = 1
MAX_BYTES = 2**28  # a policy of a quarter of a gigabyte is a mistake


@struct.dataclass
class SteeringPolicy:
    """Normaliser, network, tanh and action scale: everything between terrain and command.

    Attributes:
        mean: of the normaliser, in the observation's units.
        deviation: likewise.
        kernels: of the layers, each [inputs, outputs].
        biases: of the layers.
        activation: between layers, a name of Brax's.
        config: of the environment it was trained in: observation layout, limits, heights.
    """

    mean: Float[Array, " size"]
    deviation: Float[Array, " size"]
    kernels: tuple[Array, ...]
    biases: tuple[Array, ...]
    activation: str = struct.field(pytree_node=False)
    config: SteeringConfig = struct.field(pytree_node=False)

    @property
    def limits(self) -> MotionLimits:
        """Bounds of the commands."""
        return self.config.limits

    def action(self, observation: Float[Array, "*batch size"]) -> Float[Array, "*batch 4"]:
        """Return the mean action in [-1, 1]^4, as the environment's `step` takes it."""

        def across(vector: Array) -> Array:  # the batch axes, written out
            return vector.reshape((1,) * (observation.ndim - 1) + vector.shape)

        normalised = (observation - across(self.mean)) / across(self.deviation)
        hidden = jnp.clip(normalised, -MAX_NORMALISED, MAX_NORMALISED)
        for index, (kernel, bias) in enumerate(zip(self.kernels, self.biases, strict=True)):
            hidden = hidden @ kernel + across(bias)
            if index < len(self.kernels) - 1:
                hidden = ACTIVATION[self.activation](hidden)
        return jnp.tanh(hidden[..., :ACTION_SIZE])  # the other outputs are exploration's

    def __call__(self, observation: Float[Array, "*batch size"]) -> Float[Array, "*batch 4"]:
        """Return acceleration in the root frame [m/s^2] and turn rate [rad/s]."""
        return scale_action(self.action(observation), self.limits)


def policy_of(
    env: SteeringEnv, activation: str, normaliser: Normaliser, params: Any
) -> SteeringPolicy:
    """Return the policy that Brax's parameters stand for."""
    layers = params["params"]
    names = sorted(layers, key=lambda name: int(name.removeprefix("hidden_")))
    return SteeringPolicy(
        mean=normaliser.mean,  # type: ignore[arg-type]
        deviation=normaliser.std,  # type: ignore[arg-type]
        kernels=tuple(layers[name]["kernel"] for name in names),
        biases=tuple(layers[name]["bias"] for name in names),
        activation=activation,
        config=env.config,
    )


def write_policy(path: str | Path, policy: SteeringPolicy) -> None:
    """Write a policy as plain arrays and a JSON text."""
    metadata = {
        "format": FORMAT,
        "activation": policy.activation,
        "config": policy.config.model_dump(mode="json"),
    }
    arrays = {f"kernel_{index}": np.asarray(each) for index, each in enumerate(policy.kernels)}
    arrays |= {f"bias_{index}": np.asarray(each) for index, each in enumerate(policy.biases)}
    write_npz(
        path,
        metadata=np.array(json.dumps(metadata)),
        mean=np.asarray(policy.mean),
        deviation=np.asarray(policy.deviation),
        **arrays,
    )


def read_policy(path: str | Path) -> SteeringPolicy:
    """Read a policy.

    Raises:
        InputError: the file is not a policy, is damaged, or is of another format.
    """
    required = ("metadata", "mean", "deviation", "kernel_0", "bias_0")
    arrays = read_npz(path, required, max_bytes=MAX_BYTES)
    try:
        metadata = parse_json(str(arrays["metadata"]), f"{path}: its metadata")
        if metadata["format"] != FORMAT:
            raise InputError(
                f"{path} is a policy of format {metadata['format']}; this version reads {FORMAT}"
            )
        config = SteeringConfig.model_validate(metadata["config"])
        activation = str(metadata["activation"])
        if activation not in ACTIVATION:
            raise ValueError(f"activation {activation!r}")
    except ValidationError as error:
        first = error.errors()[0]
        key = ".".join(map(str, first["loc"]))
        raise InputError(f"{path}: config.{key} of its metadata: {first['msg']}") from error
    except (KeyError, TypeError, ValueError) as error:
        raise InputError(f"{path}: its metadata is not a steering policy's: {error}") from error
    count = _require_layers(path, arrays)
    policy = SteeringPolicy(
        mean=jnp.asarray(arrays["mean"]),
        deviation=jnp.asarray(arrays["deviation"]),
        kernels=tuple(jnp.asarray(arrays[f"kernel_{index}"]) for index in range(count)),
        biases=tuple(jnp.asarray(arrays[f"bias_{index}"]) for index in range(count)),
        activation=activation,
        config=config,
    )
    _check_shapes(path, policy)
    return policy


def _require_layers(path: str | Path, arrays: dict[str, np.ndarray]) -> int:
    """Return the number of layers; refuse one without bias, and what is no finite number."""
    count = sum(name.startswith("kernel_") for name in arrays)
    layers = [f"{part}_{index}" for index in range(count) for part in ("kernel", "bias")]
    for name in ("mean", "deviation", *layers):
        array = arrays.get(name)
        if array is None or array.dtype.kind != "f" or not np.isfinite(array).all():
            raise InputError(f"{path}: {name} is missing, or holds what is no finite number")
    if not (arrays["deviation"] > 0.0).all():
        raise InputError(f"{path}: deviation must be positive")
    return count


def _check_shapes(path: str | Path, policy: SteeringPolicy) -> None:
    size = layout_named(policy.config.observation).size
    chain = [size, *(bias.shape[-1] if bias.ndim == 1 else -1 for bias in policy.biases)]
    expected = list(itertools.pairwise(chain))
    shapes = [kernel.shape for kernel in policy.kernels]
    if (
        shapes != expected
        or policy.mean.shape != (size,)
        or policy.deviation.shape != (size,)
        or chain[-1] < ACTION_SIZE
    ):
        raise InputError(
            f"{path}: layers of shape {shapes} are no policy for the {size} values of"
            f" {policy.config.observation}"
        )
