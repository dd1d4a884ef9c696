"""One named part of an observation."""

from dataclasses import dataclass
from math import prod
from typing import Any

import numpy as np

from jaxleas.envs.mirror import Mirror, require_mirror
from jaxleas.types import InputError

Numbers = float | tuple[float, ...]


@dataclass(frozen=True)
class Part:
    """One part of an observation: a vector [n], or a map [rows, columns].

    Attributes:
        name: name of the part, and of its ONNX input.
        shape: shape of its values.
        mean: middle of each value's range, in its unit: one number, or one for each value, flat.
        deviation: half of each value's range, likewise: the network sees
            (value - mean) / deviation.
        mirror: image of the flattened values when left and right are swapped; None where there is
            no such symmetry.
        critic_only: whether only the critic sees the part, in training.
    """

    name: str
    shape: tuple[int, ...]
    mean: Numbers = 0.0
    deviation: Numbers = 1.0
    mirror: Mirror | None = None
    critic_only: bool = False

    def __post_init__(self) -> None:
        what, shape = f"the part {self.name!r}", self.shape
        is_shape = isinstance(shape, tuple) and len(shape) in (1, 2)
        if not is_shape or not all(_is_count(side) for side in shape):
            raise InputError(
                f"{what} has the shape {shape!r}; give (n,) for a vector, (rows, columns) for a map"
            )
        for kind in ("mean", "deviation"):
            numbers = np.asarray(getattr(self, kind), np.float32)
            if numbers.shape not in ((), (self.size,)) or not np.isfinite(numbers).all():
                raise InputError(
                    f"{what} has {self.size} values, but its {kind} is {getattr(self, kind)!r}:"
                    f" give one finite number, or a tuple of {self.size}"
                )
        if not np.all(np.asarray(self.deviation) > 0.0):
            raise InputError(f"{what} has the deviation {self.deviation!r}, which must be above 0")
        require_mirror(self.mirror, self.size, what)

    @property
    def size(self) -> int:
        """Number of values."""
        return prod(self.shape)

    @property
    def is_map(self) -> bool:
        """Whether its values lie on a grid, for networks that have an encoder of maps."""
        return len(self.shape) == 2


def _is_count(side: Any) -> bool:
    return isinstance(side, int | np.integer) and int(side) > 0
