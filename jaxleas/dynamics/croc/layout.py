"""Programs as the JAX solver wants them, and its inequalities as a few arrays.

Axes: N programs; S phases, W force instants, P points, F faces; G groups of L instants with R rows.
"""

from collections.abc import Callable
from typing import NamedTuple

import jax
import jax.numpy as jnp
from jaxtyping import Bool, Float

from jaxleas.dynamics.croc.curves import cross_product
from jaxleas.dynamics.croc.program import Programs, Rows

Slacks = tuple[jax.Array, ...]
"""One number of each inequality: [N, S, W, P, F] of forces, then [N, G, L, R] of each `Rows`."""


class Layout(NamedTuple):
    """Programs of one batch axis; see `Programs`."""

    programs: Programs
    wrenches: Float[jax.Array, "N S P 6 3"]
    least: Float[jax.Array, "N 1 1 1 F"]
    standing: Bool[jax.Array, "N S 1 P 1"]

    @property
    def rows(self) -> tuple[Rows, ...]:
        """Limits on the free point alone."""
        return self.programs.reach, self.programs.acceleration

    def slacks(self, x: jax.Array, margin: jax.Array, forces: jax.Array) -> Slacks:
        """Return the slack of each inequality at a point; 1 for points that do not stand."""
        step = jnp.concatenate([x, margin[:, None]], axis=-1)
        force, *others = self.changes(step, forces)
        force = jnp.where(self.standing, force - self.least, 1.0)
        return (force, *(a + b.bounds for a, b in zip(others, self.rows, strict=True)))

    def changes(self, step: Float[jax.Array, "N 4"], forces: jax.Array) -> Slacks:
        """Return the changes of all slacks for a step (x and margin) and changes of the forces."""
        margin = step[:, 3]
        along = jnp.einsum("nswpi,nspfi->nswpf", forces, self.programs.faces)
        found = [jnp.where(self.standing, along - margin[:, None, None, None, None], 0.0)]
        for block in self.rows:
            sideways = jnp.einsum("ngri,ni->ngr", block.rows, step[:, :3])
            fall = block.share[..., None] * sideways[:, :, None]
            found.append(-fall - margin[:, None, None, None])
        return tuple(found)

    def masked(self, slacks: Slacks) -> Slacks:
        """Return the slacks with zeros for points that do not stand."""
        return (jnp.where(self.standing, slacks[0], 0.0), *slacks[1:])

    def imbalance(self, x: jax.Array, forces: jax.Array) -> Float[jax.Array, "N S W 6"]:
        """Return the wrench of the forces, less the wrench needed."""
        p, point = self.programs, x[:, None, None]
        push = p.push + p.push_share[..., None] * point
        turn = p.turn + cross_product(p.turn_slope, jnp.broadcast_to(point, p.turn.shape))
        return self.wrench(forces) - jnp.concatenate([push, turn], axis=-1)

    def wrench(self, forces: Float[jax.Array, "N S W P 3"]) -> Float[jax.Array, "N S W 6"]:
        """Return force and torque of all standing points together."""
        return jnp.einsum("nspki,nswpi->nswk", self.wrenches, forces)

    def pulled_back(self, wrench: Float[jax.Array, "N S W 6"]) -> Float[jax.Array, "N S W P 3"]:
        """Return the transpose of `wrench`."""
        return jnp.einsum("nspki,nswk->nswpi", self.wrenches, wrench)


def layout_of(programs: Programs) -> Layout:
    """Return programs of one batch axis with what the solver derives from them.

    Args:
        programs: programs in JAX arrays.
    """
    x, y, z = (programs.arms[..., axis] for axis in range(3))
    zero = jnp.zeros_like(x)
    rows = [jnp.broadcast_to(row, programs.arms.shape) for row in jnp.eye(3, dtype=x.dtype)]
    rows += [jnp.stack(row, axis=-1) for row in ((zero, -z, y), (z, zero, -x), (-y, x, zero))]
    wrenches = jnp.stack(rows, axis=-2) * programs.standing[..., None, None]
    is_last = jnp.arange(programs.faces.shape[-2]) == programs.faces.shape[-2] - 1
    least = jnp.where(is_last, -programs.limit[:, None], 0.0)
    return Layout(
        programs, wrenches, least[:, None, None, None], programs.standing[:, :, None, :, None]
    )


def sum_of(slacks: Slacks) -> Float[jax.Array, " N"]:
    """Return the sum over all inequalities of each program."""
    return _over_all(jnp.sum, jnp.add, slacks)


def largest_of(slacks: Slacks) -> Float[jax.Array, " N"]:
    """Return the largest over all inequalities of each program."""
    return _over_all(jnp.max, jnp.maximum, slacks)


def combined(function: Callable[..., jax.Array], *slacks: Slacks) -> Slacks:
    """Return a function of the entries of several slacks."""
    return tuple(function(*each) for each in zip(*slacks, strict=True))


def spread(number: Float[jax.Array, " N"], like: jax.Array) -> jax.Array:
    """Return one number of each program, ready to be combined with an array of all axes."""
    return number.reshape(-1, *[1] * (like.ndim - 1))


def _over_all(
    reduce: Callable[..., jax.Array], join: Callable[..., jax.Array], slacks: Slacks
) -> jax.Array:
    found = [reduce(array, axis=tuple(range(1, array.ndim))) for array in slacks]
    total = found[0]
    for other in found[1:]:
        total = join(total, other)
    return total
