"""Mirroring left and right, as an order and a sign for the values of a vector."""

from collections.abc import Sequence
from dataclasses import dataclass

import jax.numpy as jnp
import numpy as np
from jax import Array
from jaxtyping import Float

from jaxleas.xla import take_inside


@dataclass(frozen=True)
class Mirror:
    """The image of a vector when left and right are swapped: `sign * vector[order]`.

    Attributes:
        order: index in the vector from which each value of its image is taken.
        sign: 1 or -1 for each value of the image.
    """

    order: tuple[int, ...]
    sign: tuple[float, ...]

    @classmethod
    def of_signs(cls, sign: Sequence[float]) -> "Mirror":
        """Return the mirror that moves no value and changes some signs."""
        return cls(tuple(range(len(sign))), tuple(map(float, sign)))

    @classmethod
    def of_map(cls, rows: int, columns: int, lateral_axis: int = 1) -> "Mirror":
        """Return the mirror of a map, flattened row by row.

        Args:
            rows: number of rows.
            columns: number of columns.
            lateral_axis: index (0 or 1) of the axis that runs from right to left.
        """
        places = np.flip(np.arange(rows * columns).reshape(rows, columns), axis=lateral_axis)
        return cls(tuple(map(int, places.ravel())), (1.0,) * places.size)

    @classmethod
    def join(cls, mirrors: Sequence["Mirror"]) -> "Mirror":
        """Return the mirror of several vectors, one after another."""
        order: list[int] = []
        for each in mirrors:
            begin = len(order)
            order += [begin + place for place in each.order]
        return cls(tuple(order), tuple(sign for each in mirrors for sign in each.sign))

    def __call__(self, vector: Float[Array, "*batch size"]) -> Float[Array, "*batch size"]:
        """Return the image of a vector."""
        sign = jnp.asarray(self.sign, jnp.float32)
        return self.without_signs(vector) * sign.reshape((1,) * (vector.ndim - 1) + (-1,))

    def without_signs(self, vector: Float[Array, "*batch size"]) -> Float[Array, "*batch size"]:
        """Return the image of unsigned values, such as deviations: they only change place."""
        if self.order == tuple(range(len(self.order))):
            return vector
        order = jnp.asarray(self.order, jnp.int32)
        return take_inside(vector, (..., order))
