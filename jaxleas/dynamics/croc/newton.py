"""One Newton step of the interior point method: factors on the arrow structure, and directions."""

from typing import NamedTuple

import jax
import jax.numpy as jnp
from jaxtyping import Bool, Float

from jaxleas.dynamics.croc.layout import Layout, Slacks, sum_of
from jaxleas.dynamics.croc.solution import PROXIMAL

_FLOOR = 1e-15  # share of the diagonal added to balances: keeps factors of spent systems finite


class Factors(NamedTuple):
    """What is left of the Newton matrix after elimination; see `factorise`."""

    softness: Float[jax.Array, "N S W P 3 3"]  # inverse of each point's block
    pull: Float[jax.Array, "N S W P 3"]  # each point's coupling with the margin
    balance: Float[jax.Array, "N S W 6 6"]  # inverse of each instant's lower factor
    arrow: Float[jax.Array, "N S W 6 4"]  # its couplings with x and margin, solved forwards
    head: Float[jax.Array, "N 4 4"]  # inverse of each program's lower factor


def factorise(layout: Layout, weights: Slacks) -> Factors:
    """Eliminate forces, then balances, from the Newton matrix.

    Args:
        layout: programs.
        weights: dual over slack of each inequality.
    """
    force, faces = weights[0], layout.programs.faces
    blocks = jnp.einsum("nswpf,nspfi,nspfk->nswpik", force, faces, faces)
    blocks = blocks + PROXIMAL * jnp.eye(3, dtype=blocks.dtype)
    pull = jnp.einsum("nswpf,nspfi->nswpi", force, faces)
    softness = _inverse(blocks, layout.standing[..., 0])
    balance = inverse_factor(gram(layout, softness))
    arrow = balance @ _couplings(layout, softness, pull)
    eaten = jnp.einsum("nswpi,nswpik,nswpk->n", pull, softness, pull)
    head = _head_of(layout, weights) + jnp.einsum("nswki,nswkj->nij", arrow, arrow)
    head = head.at[:, 3, 3].add(force.sum(axis=(1, 2, 3, 4)) - eaten)
    return Factors(softness, pull, balance, arrow, inverse_factor(head))


def direction(
    layout: Layout, factors: Factors, imbalance: jax.Array, targets: Slacks | None
) -> tuple[Float[jax.Array, "N 4"], Float[jax.Array, "N S W P 3"]]:
    """Return the step of x and margin, and of all forces.

    Args:
        layout: programs.
        factors: Newton matrix.
        imbalance: error of the balances.
        targets: wanted product of slack and dual, over the slack; None for zero.
    """
    softness, pull, balance, arrow, head = factors
    right = jnp.zeros_like(head[:, 0]).at[:, 3].set(1.0)
    wanted = jnp.zeros_like(pull)
    if targets is not None:
        wanted = jnp.einsum("nswpf,nspfi->nswpi", targets[0], layout.programs.faces)
        bent = jnp.einsum("nswpik,nswpk->nswpi", softness, wanted)
        imbalance = imbalance + layout.wrench(bent)
        for rows, target in zip(layout.rows, targets[1:], strict=True):
            along = jnp.einsum("nglr,ngl,ngri->ni", target, rows.share, rows.rows)
            right = right.at[:, :3].add(-along)
        margin = jnp.einsum("nswpi,nswpi->n", pull, bent) - sum_of(targets)
        right = right.at[:, 3].add(margin)
    solved = jnp.einsum("nswkj,nswj->nswk", balance, imbalance)
    right = right + jnp.einsum("nswki,nswk->ni", arrow, solved)
    step = jnp.einsum("nki,nkj,nj->ni", head, head, right)
    rest = solved - jnp.einsum("nswki,ni->nswk", arrow, step)
    back = layout.pulled_back(jnp.einsum("nswkj,nswk->nswj", balance, rest))
    driven = pull * step[:, 3, None, None, None, None] + wanted - back
    return step, jnp.einsum("nswpik,nswpk->nswpi", softness, driven)


def gram(layout: Layout, softness: jax.Array) -> Float[jax.Array, "N S W 6 6"]:
    """Return E S E^T of each instant, for the wrenches E of forces and a symmetric S each point."""
    bent = jnp.einsum("nspki,nswpij->nswpkj", layout.wrenches, softness)
    return jnp.einsum("nswpkj,nsplj->nswkl", bent, layout.wrenches)


def inverse_factor(matrix: Float[jax.Array, "*batch K K"]) -> Float[jax.Array, "*batch K K"]:
    """Return the inverse of the lower Cholesky factor; not finite if there is none."""
    identity = jnp.eye(matrix.shape[-1], dtype=matrix.dtype)
    factor = jnp.linalg.cholesky(matrix + _FLOOR * identity * matrix, symmetrize_input=False)
    return jax.lax.linalg.triangular_solve(
        factor, jnp.broadcast_to(identity, factor.shape), left_side=True, lower=True
    )


def _couplings(layout: Layout, softness: jax.Array, pull: jax.Array) -> jax.Array:
    """Return the columns of each balance that multiply x and the margin, [N, S, W, 6, 4]."""
    p = layout.programs
    a, b, c = (p.turn_slope[..., axis] for axis in range(3))
    s, zero = p.push_share, jnp.zeros_like(p.push_share)
    margin = -layout.wrench(jnp.einsum("nswpik,nswpk->nswpi", softness, pull))
    columns = [
        (s, zero, zero, zero, c, -b),
        (zero, s, zero, -c, zero, a),
        (zero, zero, s, b, -a, zero),
    ]
    return jnp.stack([*(jnp.stack(each, axis=-1) for each in columns), margin], axis=-1)


def _head_of(layout: Layout, weights: Slacks) -> Float[jax.Array, "N 4 4"]:
    """Return the block of x and margin that limits on x alone make."""
    head = jnp.zeros((len(layout.wrenches), 4, 4), layout.wrenches.dtype)
    for rows, weight in zip(layout.rows, weights[1:], strict=True):
        once = jnp.einsum("nglr,ngl->ngr", weight, rows.share)
        twice = jnp.einsum("nglr,ngl->ngr", weight, rows.share * rows.share)
        corner = jnp.einsum("ngr,ngri,ngrk->nik", twice, rows.rows, rows.rows)
        edge = jnp.einsum("ngr,ngri->ni", once, rows.rows)
        head = head.at[:, :3, :3].add(corner)
        head = head.at[:, 3, :3].add(edge).at[:, :3, 3].add(edge)
        head = head.at[:, 3, 3].add(weight.sum(axis=(1, 2, 3)))
    return head


def _inverse(blocks: Float[jax.Array, "*batch 3 3"], where: Bool[jax.Array, "*batch"]) -> jax.Array:
    """Return the inverse of symmetric 3 x 3 matrices, zeros elsewhere."""
    # By its factors, not by cofactors: they cancel where a force lies at an edge of its pyramid.
    blocks = jnp.where(where[..., None, None], blocks, jnp.eye(3, dtype=blocks.dtype))
    a, b, d = blocks[..., 0, 0], blocks[..., 1, 0], blocks[..., 2, 0]
    b, d, first, second = b / a, d / a, b, d
    c = blocks[..., 1, 1] - b * first
    e = (blocks[..., 2, 1] - d * first) / c
    f = blocks[..., 2, 2] - d * second - e * e * c
    low = b * e - d
    p, q, r = 1.0 / a, 1.0 / c, 1.0 / f
    edge = -b * q - e * low * r
    rows = [
        (p + b * b * q + low * low * r, edge, low * r),
        (edge, q + e * e * r, -e * r),
        (low * r, -e * r, r),
    ]
    found = jnp.stack([jnp.stack(row, axis=-1) for row in rows], axis=-2)
    return jnp.where(where[..., None, None], found, 0.0)
