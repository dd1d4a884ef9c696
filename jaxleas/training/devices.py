"""The devices that share a training: robots are divided among them, the rest is on each.

One program over global arrays (`jax.jit` with shardings): what it computes does not depend on the
number of devices, except for the order in which sums over robots are rounded.
"""

import dataclasses
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Literal, TypeVar

import jax
import jax.numpy as jnp
import numpy as np
from jax.sharding import Mesh, NamedSharding, PartitionSpec

from jaxleas.training.config import PpoConfig
from jaxleas.training.train_state import TrainState
from jaxleas.types import InputError

Tree = TypeVar("Tree")
AXIS = "robots"
DIVIDED = ("episode", "observation")  # fields of the train state with one entry per robot


@dataclass(frozen=True)
class Devices:
    """Devices in a row, of this process alone or of all processes of a training.

    Attributes:
        mesh: the devices, along one axis.
    """

    mesh: Mesh

    @classmethod
    def of(cls, devices: Sequence[Any]) -> "Devices":
        """Return these devices in a row."""
        return cls(Mesh(np.array(devices), (AXIS,)))

    def __len__(self) -> int:
        """Return the number of devices."""
        return self.mesh.size

    @property
    def whole(self) -> NamedSharding:
        """Sharding of arrays that every device holds whole: terrain, parameters, metrics."""
        return NamedSharding(self.mesh, PartitionSpec())

    @property
    def divided(self) -> NamedSharding:
        """Sharding of arrays with one entry per robot along their first axis."""
        return NamedSharding(self.mesh, PartitionSpec(AXIS))

    @property
    def state(self) -> TrainState:
        """Layout of a train state: a sharding for each of its fields."""
        names = [field.name for field in dataclasses.fields(TrainState)]
        layout: Any = {name: self.divided if name in DIVIDED else self.whole for name in names}
        return TrainState(**layout)

    def divide(self, robots: Tree) -> Tree:
        """Lay arrays with one entry per robot out over the devices, where they can be divided."""
        count = len(jax.tree.leaves(robots)[0])
        if len(self) == 1 or count % len(self):
            return robots
        return jax.lax.with_sharding_constraint(robots, self.divided)

    def share(self, function: Callable[..., Any], robot_axes: Sequence[Any]) -> Callable[..., Any]:
        """Return a function that every device computes for its own robots.

        Left to itself, the compiler gathers each minibatch on every device and sums each array of
        the gradient separately.

        Args:
            function: function that returns the same on each device.
            robot_axes: axis of each argument, or of each part of it, along which its arrays have
                one entry per robot or group of robots; None: every device has the whole.
        """
        specs = jax.tree.map(
            lambda axis: PartitionSpec() if axis is None else PartitionSpec(*(None,) * axis, AXIS),
            tuple(robot_axes),
            is_leaf=lambda axis: axis is None,
        )
        return jax.shard_map(
            function, mesh=self.mesh, in_specs=specs, out_specs=PartitionSpec(), check_vma=False
        )

    def place(self, state: TrainState) -> TrainState:
        """Return a state laid out over the devices; all processes must call it.

        Args:
            state: state of process 0, as read from a checkpoint; the other processes pass only its
                shapes (from `jax.eval_shape`).
        """

        if not self.mesh.is_multi_process:
            return jax.tree.map(jax.device_put, state, jax.tree.broadcast(self.state, state))
        leaves, structure = jax.tree.flatten(state)
        is_key = [jnp.issubdtype(leaf.dtype, jax.dtypes.prng_key) for leaf in leaves]

        def lay_out(words: list[jax.Array]) -> TrainState:
            wrapped = [
                jax.random.wrap_key_data(each) if key else each
                for each, key in zip(words, is_key, strict=True)
            ]
            return jax.tree.unflatten(structure, wrapped)

        words = [_from_first(leaf) for leaf in leaves]
        return jax.jit(lay_out, out_shardings=self.state)(words)

    def gather(self, state: TrainState) -> TrainState:
        """Return a state whose arrays this process can read whole; all processes must call it."""
        if self.mesh.is_multi_process:
            return jax.jit(lambda tree: tree, out_shardings=self.whole)(state)
        return state


def choose_devices(count: int | Literal["all"], ppo: PpoConfig) -> Devices:
    """Return the devices to train on.

    Args:
        count: number of JAX's devices, counted over all processes; `"all"`: all of them.
        ppo: configuration of PPO, whose robots the devices share.

    Raises:
        InputError: there are fewer devices, they do not divide the robots of a minibatch, or a
            process would have none.
    """
    there = jax.devices()
    wanted = len(there) if count == "all" else count
    if wanted > len(there):
        raise InputError(f"--devices {wanted}: JAX finds {len(there)} here ({_kinds(there)})")
    if jax.process_count() > 1 and wanted < len(there):
        raise InputError(
            f"--devices {wanted}: {jax.process_count()} processes have {len(there)} devices and"
            " take part with all of them: leave --devices out"
        )
    _require_even(wanted, ppo)
    return Devices.of(there[:wanted])


def one_device() -> Devices:
    """Return the first device of this process alone."""
    return Devices.of(jax.local_devices()[:1])


def _from_first(leaf: Any) -> np.ndarray:
    """Return process 0's array on every process; for a random key, its words.

    The other processes pass only its shape.
    """
    from jax.experimental.multihost_utils import broadcast_one_to_all

    if jnp.issubdtype(leaf.dtype, jax.dtypes.prng_key):
        held = isinstance(leaf, jax.Array)
        leaf = jax.random.key_data(leaf) if held else jax.eval_shape(jax.random.key_data, leaf)
    whole = leaf if isinstance(leaf, jax.Array) else np.zeros(leaf.shape, leaf.dtype)
    return np.asarray(broadcast_one_to_all(np.asarray(whole)))


def _require_even(count: int, ppo: PpoConfig) -> None:
    robots = ppo.environments // ppo.minibatches
    if robots % count:
        fitting = [number for number in range(1, count) if robots % number == 0]
        raise InputError(
            f"{count} devices cannot share the robots evenly: ppo.environments ="
            f" {ppo.environments} in ppo.minibatches = {ppo.minibatches} are {robots} per"
            f" minibatch, no multiple of {count}; --devices {fitting[-1]} would do, or other"
            " numbers of these"
        )


def _kinds(devices: Sequence[Any]) -> str:
    kinds = [each.device_kind for each in devices]
    return ", ".join(f"{kinds.count(kind)} x {kind}" for kind in sorted(set(kinds)))
