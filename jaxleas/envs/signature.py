"""The interface of a policy: named parts of its observation, and heads of its action.

Between task and network an observation is one vector, all parts one after another, each flattened
row by row; so storing, scaling, mirroring and learning do not depend on parts.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from math import prod
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array
from jaxtyping import Float, Key

from jaxleas.envs.array_checks import kind_of
from jaxleas.envs.heads.head import Head
from jaxleas.envs.mirror import Mirror
from jaxleas.envs.part import Numbers, Part
from jaxleas.types import InputError
from jaxleas.xla import split


@dataclass(frozen=True)
class Signature:
    """Parts of the observation and heads of the action, in order.

    Attributes:
        parts: parts of the observation.
        heads: heads of the action.
    """

    parts: tuple[Part, ...]
    heads: tuple[Head, ...]

    def __post_init__(self) -> None:
        for kind, items in (("parts", self.parts), ("heads", self.heads)):
            if not isinstance(items, tuple) or not items:
                raise InputError(
                    f"the signature's {kind} are {kind_of(items)}; give a tuple of one at least, as"
                    f" in ({kind[:-1]},)"
                )
            names = [item.name for item in items]
            if len(set(names)) < len(names) or not all(isinstance(name, str) for name in names):
                raise InputError(f"the signature's {kind} need names, each one once: {names}")
        if all(part.critic_only for part in self.parts):
            raise InputError(
                "every part of the observation is critic_only; the policy must see one at least"
            )

    @cached_property
    def size(self) -> int:
        """Number of values in an observation."""
        return sum(part.size for part in self.parts)

    @cached_property
    def seen(self) -> tuple[Part, ...]:
        """The parts that the actor sees."""
        return tuple(part for part in self.parts if not part.critic_only)

    @cached_property
    def scaling(self) -> tuple[Float[np.ndarray, " size"], Float[np.ndarray, " size"]]:
        """Mean and deviation of an observation's values."""
        mean = [_each(part.mean, part.size) for part in self.parts]
        deviation = [_each(part.deviation, part.size) for part in self.parts]
        return np.concatenate(mean), np.concatenate(deviation)

    @cached_property
    def symmetric(self) -> bool:
        """Whether all parts and heads have a mirror."""
        return all(part.mirror for part in self.parts) and all(
            head.symmetric for head in self.heads
        )

    @cached_property
    def mirror(self) -> Mirror:
        """The image of an observation when left and right are swapped."""
        return Mirror.join([part.mirror for part in self.parts if part.mirror is not None])

    def pack(self, observation: Any) -> Any:
        """Return an observation as one vector.

        Args:
            observation: arrays [*batch, *shape] by the parts' names; where there is only one
                part, the array alone. Arrays are of JAX or NumPy.

        Returns:
            An array [*batch, size].

        Raises:
            InputError: a part is missing.
        """
        if not isinstance(observation, Mapping):
            observation = {self.parts[0].name: observation}
        missing = [part.name for part in self.parts if part.name not in observation]
        if missing:
            names = ", ".join(part.name for part in self.parts)
            raise InputError(f"an observation lacks the part {missing[0]}; give arrays of {names}")
        flat = [_flat(observation[part.name], part.shape) for part in self.parts]
        if len(flat) == 1:
            return flat[0]
        return _join(flat)

    def for_actor(self, observation: Any) -> Any:
        """Return the part of packed observations that the actor sees: an array [*batch, seen]."""
        if len(self.seen) == len(self.parts):
            return observation
        ends = np.cumsum([part.size for part in self.parts])
        kept = [
            observation[..., end - part.size : end]
            for part, end in zip(self.parts, ends, strict=True)
            if not part.critic_only
        ]
        return kept[0] if len(kept) == 1 else _join(kept)

    @cached_property
    def action_size(self) -> int:
        """Length of a raw action of all heads."""
        return sum(head.size for head in self.heads)

    @cached_property
    def logits(self) -> int:
        """Length of the answer of the actor's network."""
        return sum(sum(head.logits) for head in self.heads)

    def distributions(self, logits: Float[Array, "*batch logits"]) -> tuple[Any, ...]:
        """Return the distribution of each head."""
        return tuple(
            head.distribution(*each)
            for head, each in zip(self.heads, self._by_head(logits), strict=True)
        )

    def draw_noise(self, key: Key[Array, ""], shape: tuple[int, ...]) -> tuple[Array, ...]:
        """Draw the noise of samples in bulk, for each head [*shape, noise]."""
        keys = [key] if len(self.heads) == 1 else jax.random.split(key, len(self.heads))
        return tuple(
            head.draw_noise(each, shape) for head, each in zip(self.heads, keys, strict=True)
        )

    def sample(self, distributions: Sequence[Any], noise: Sequence[Array]) -> Array:
        """Return raw actions, one vector [*batch, action_size]."""
        raw = [
            head.sample(*each) for head, *each in zip(self.heads, distributions, noise, strict=True)
        ]
        return raw[0] if len(raw) == 1 else jnp.concatenate(raw, axis=-1)

    def action(self, raw: Float[Array, "*batch action_size"]) -> Any:
        """Return the action that the environment takes: by head, or that of the only head alone."""
        return self._named(
            [head.action(each) for head, each in zip(self.heads, self.raw(raw), strict=True)]
        )

    def mode(self, logits: Float[Array, "*batch logits"]) -> Any:
        """Return the deterministic action, in the form that `action` returns."""
        return self._named(
            [head.mode(*each) for head, each in zip(self.heads, self._by_head(logits), strict=True)]
        )

    def command(self, action: Any) -> Any:
        """Return an action in physical units: by head, or that of the only head alone."""
        if len(self.heads) == 1:
            return self.heads[0].command(action)
        return {head.name: head.command(action[head.name]) for head in self.heads}

    def raw(self, raw: Float[Array, "*batch action_size"]) -> tuple[Array, ...]:
        """Return each head's part of raw actions."""
        return split(raw, [head.size for head in self.heads])

    def _by_head(self, logits: Array) -> list[tuple[Array, ...]]:
        sizes = [size for head in self.heads for size in head.logits]
        parts = iter(split(logits, sizes))
        return [tuple(next(parts) for _ in head.logits) for head in self.heads]

    def _named(self, each: Sequence[Array]) -> Any:
        if len(each) == 1:
            return each[0]
        return {head.name: value for head, value in zip(self.heads, each, strict=True)}


def _each(number: Numbers, size: int) -> np.ndarray:
    return np.broadcast_to(np.asarray(number, np.float32), size)


def _join(parts: list[Any]) -> Any:
    numpy = all(isinstance(each, np.ndarray) for each in parts)
    return (np if numpy else jnp).concatenate(parts, axis=-1)


def _flat(values: Any, shape: tuple[int, ...]) -> Any:
    if len(shape) == 1:
        return values
    return values.reshape(*values.shape[: values.ndim - len(shape)], prod(shape))
