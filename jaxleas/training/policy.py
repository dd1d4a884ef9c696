"""A trained policy by itself: observation in physical units to command in physical units.

This is the value that leaves training: roll-outs, evaluation and export all use it, so what is
judged is what is shipped. As a file it is plain arrays and one JSON text (`policy.npz`).
"""

import json
from collections.abc import Collection, Mapping
from pathlib import Path
from typing import Any

import jax.numpy as jnp
import numpy as np
from flax import struct
from jax import Array
from jaxtyping import Float
from pydantic import ValidationError

from jaxleas.envs import DEFAULT_TASK, TASKS, Signature, TaskConfig
from jaxleas.files import parse_json, read_npz, write_npz
from jaxleas.training.networks import ActorCritic, Network, network_described
from jaxleas.training.normaliser import MAX_NORMALISED, Normaliser
from jaxleas.types import InputError

FORMAT = 1
MAX_BYTES = 2**28  # a policy of a quarter of a gigabyte is a mistake


@struct.dataclass
class Policy:
    """Normaliser, network, heads and scales: everything between observation and command.

    Attributes:
        mean: mean of the normaliser, in the observation's units.
        deviation: deviation of the normaliser, likewise.
        params: parameters of the network.
        network: kind and sizes of the network.
        signature: observation that the policy is shown, and meaning of its answer.
        config: configuration of the task that the policy was trained for.
    """

    mean: Float[Array, " size"]
    deviation: Float[Array, " size"]
    params: Any
    network: Network = struct.field(pytree_node=False)
    signature: Signature = struct.field(pytree_node=False)
    config: Any = struct.field(pytree_node=False)

    def answer(self, observation: Array | Mapping[str, Array]) -> Float[Array, "*batch logits"]:
        """Return what the network answers.

        Args:
            observation: observation for the actor, in physical units: by part, or that of the only
                part alone.
        """
        return self.answer_vector(self._as_shown.pack(observation))

    def answer_vector(self, seen: Float[Array, "*batch size"]) -> Float[Array, "*batch logits"]:
        """Return what the network answers to an observation that is one vector."""

        def across(vector: Array) -> Array:  # the batch axes, written out
            return vector.reshape((1,) * (seen.ndim - 1) + vector.shape)

        normalised = (seen - across(self.mean)) / across(self.deviation)
        rows = jnp.clip(normalised, -MAX_NORMALISED, MAX_NORMALISED)
        return self.network.plain(self.params, rows)

    def action(self, observation: Array | Mapping[str, Array]) -> Any:
        """Return the deterministic action, as the task's `advance` takes it."""
        return self.signature.mode(self.answer(observation))

    def __call__(self, observation: Array | Mapping[str, Array]) -> Any:
        """Return the command in physical units: by head, or that of the only head alone."""
        return self.signature.command(self.action(observation))

    @property
    def _as_shown(self) -> Signature:
        """The signature without the parts for the critic alone."""
        return Signature(self.signature.seen, self.signature.heads)


def policy_of(
    networks: ActorCritic, config: TaskConfig, normaliser: Normaliser, params: Any
) -> Policy:
    """Return the policy of an actor's parameters.

    Args:
        networks: actor and critic.
        config: configuration of the task.
        normaliser: normaliser of observations.
        params: parameters of the actor.
    """
    signature = networks.signature
    mean, deviation = signature.for_actor(normaliser.mean), signature.for_actor(normaliser.std)
    return Policy(mean, deviation, params, networks.actor, signature, config)


def write_policy(path: str | Path, policy: Policy) -> None:
    """Write a policy as plain arrays and a JSON text."""
    metadata = {
        "format": FORMAT,
        "activation": policy.network.activation,
        "network": policy.network.describe(),
        "config": policy.config.model_dump(mode="json"),
    }
    arrays = policy.network.arrays(policy.params)
    write_npz(
        path,
        metadata=np.array(json.dumps(metadata)),
        mean=np.asarray(policy.mean),
        deviation=np.asarray(policy.deviation),
        **{name: np.asarray(each) for name, each in arrays.items()},
    )


def read_policy(
    path: str | Path,
    allow: Collection[str] = (),
    of: TaskConfig | type[TaskConfig] | None = None,
) -> Policy:
    """Read a policy.

    Args:
        path: path of the policy file.
        allow: user's own code that may be run, as MODULE:CLASS: here the policy's task.
        of: a configuration of the task, or its type, where only policies of that task are accepted.

    Raises:
        InputError: the file is not a policy, is damaged, is of another format, or of a task whose
            code may not be run.
    """
    required = ("metadata", "mean", "deviation", "kernel_0", "bias_0")
    arrays = read_npz(path, required, max_bytes=MAX_BYTES)
    try:
        metadata = parse_json(str(arrays["metadata"]), f"{path}: its metadata")
        if metadata["format"] != FORMAT:
            raise InputError(
                f"{path} is a policy of format {metadata['format']}; this version reads {FORMAT}"
            )
        found = _config(path, metadata["config"], allow, of)
        signature = found.signature()
        network = network_described(
            metadata.get("network"),
            str(metadata["activation"]),
            arrays,
            signature.seen,
            signature.logits,
        )
    except ValidationError as error:
        first = error.errors()[0]
        key = ".".join(map(str, first["loc"]))
        raise InputError(f"{path}: config.{key} of its metadata: {first['msg']}") from error
    except (KeyError, TypeError, ValueError) as error:
        raise InputError(f"{path}: its metadata is not a policy's: {error}") from error
    _require_finite(path, arrays)
    try:
        params = network.parameters(arrays)
    except ValueError as error:
        raise InputError(
            f"{path} is no policy for the {network.inputs} values of the task {found.task}: {error}"
        ) from error
    if arrays["mean"].shape != (network.inputs,) or arrays["deviation"].shape != (network.inputs,):
        raise InputError(
            f"{path}: mean and deviation are of shape {arrays['mean'].shape} and"
            f" {arrays['deviation'].shape}, but the task {found.task} shows {network.inputs} values"
        )
    mean, deviation = jnp.asarray(arrays["mean"]), jnp.asarray(arrays["deviation"])
    return Policy(mean, deviation, params, network, signature, found)


def _config(
    path: str | Path,
    stated: Any,
    allow: Collection[str],
    of: TaskConfig | type[TaskConfig] | None,
) -> TaskConfig:
    """Return the configuration of the task that a policy's file states."""
    task = stated.get("task", DEFAULT_TASK)
    if of is not None:
        wanted = of.task if isinstance(of, TaskConfig) else of.model_fields["task"].default
        if task != wanted:
            raise InputError(f"{path} is a policy of the task {task}; one of {wanted} would do")
        return of.model_validate(stated)
    try:
        found = TASKS.find(task, allow)
    except InputError as error:
        raise InputError(f"{path}: {error}") from error
    return found.Config.model_validate(stated)


def _require_finite(path: str | Path, arrays: Mapping[str, np.ndarray]) -> None:
    """Refuse arrays that are missing or hold numbers that are not finite."""
    for name, array in arrays.items():
        ours = name.startswith(("mean", "deviation", "kernel_", "bias_", "map_"))
        if ours and not (array.dtype.kind == "f" and np.isfinite(array).all()):
            raise InputError(f"{path}: {name} is missing, or holds what is no finite number")
    if not (arrays["deviation"] > 0.0).all():
        raise InputError(f"{path}: deviation must be positive")
