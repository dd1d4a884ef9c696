"""The errors of one map, drawn from random keys."""

from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array
from jaxtyping import Bool, Float, Key

from jaxleas.terrain.sensing.config import NoiseConfig
from jaxleas.terrain.sensing.filling import cells_across, filled_gaps
from jaxleas.types import NO_GROUND, is_ground


class SensedMap(NamedTuple):
    """A map as sensors give it.

    Attributes:
        heights: seen heights [m]; NO_GROUND where there is none, or none is known.
        tilt: slope by which the map is seen tilted about the root, ahead and to the left [1].
        missing: ground whose height was missing before gaps were filled.
        unknown: ground whose height is missing still.
    """

    heights: Float[Array, "rows columns"]
    tilt: Float[Array, " 2"]
    missing: Bool[Array, "rows columns"]
    unknown: Bool[Array, "rows columns"]


def sensed_map(
    heights: Float[Array, "rows columns"],
    resolution: float,
    noise: NoiseConfig,
    key: Key[Array, ""],
) -> SensedMap:
    """Return a map as sensors give it: errors, then missing cells, filled gaps, then rounding.

    Args:
        heights: true heights [m], NO_GROUND where there is none.
        resolution: side of a cell [m].
        noise: what is wrong with the map.
        key: random key, consumed here.
    """
    white_key, correlated_key, missing_key, holes_key, drift_key = jax.random.split(key, 5)
    ground, seen = is_ground(heights), heights
    if noise.white:
        seen += noise.white * jax.random.normal(white_key, heights.shape)
    if noise.correlated:
        white = jax.random.normal(correlated_key, heights.shape)
        seen += noise.correlated * smooth_field(white, noise.correlation / resolution)
    seen = jnp.where(ground, seen, heights)
    missing = jnp.zeros_like(ground)
    if noise.missing:
        missing |= jax.random.bernoulli(missing_key, noise.missing, heights.shape)
    if noise.holes:
        side = max(1, round(noise.hole_width / resolution))
        chance = 1.0 if noise.holes == 1.0 else 1.0 - (1.0 - noise.holes) ** (1.0 / side**2)
        corner = jax.random.bernoulli(holes_key, chance, heights.shape)
        missing |= squares(corner, side)
    unknown = missing
    if noise.loses_cells:
        seen, unknown = filled_gaps(seen, missing, cells_across(noise.fill, resolution))
    if noise.quantisation:
        rounded = jnp.round(seen / noise.quantisation) * noise.quantisation
        seen = jnp.where(is_ground(seen), rounded, NO_GROUND)
    angle = jax.random.uniform(drift_key, (), minval=-jnp.pi, maxval=jnp.pi)
    tilt = noise.drift * jnp.stack([jnp.cos(angle), jnp.sin(angle)])
    return SensedMap(seen, tilt, missing & ground, unknown & ground)


def smooth_field(
    white: Float[Array, "rows columns"], correlation: float
) -> Float[Array, "rows columns"]:
    """Return white noise of variance 1 as smooth noise of variance 1, periodic over the map.

    The correlation of two cells a distance d apart is exp(-(d / correlation)^2).

    Args:
        white: normal random numbers.
        correlation: distance at which the correlation has fallen to 1/e [cells].
    """
    rows, columns = white.shape
    along_y, along_x = np.fft.fftfreq(rows)[:, None], np.fft.rfftfreq(columns)[None]
    # A Gaussian of deviation `correlation` / 2, which convolved with itself is that correlation.
    gain = np.exp(-0.5 * (np.pi * correlation) ** 2 * (along_y**2 + along_x**2))
    # Columns that the half spectrum leaves out count twice.
    twice = np.full(gain.shape[1], 2.0)
    twice[0] = 1.0
    if columns % 2 == 0:
        twice[-1] = 1.0
    gain /= np.sqrt((gain**2 * twice).sum() / (rows * columns))
    return jnp.fft.irfft2(jnp.fft.rfft2(white) * jnp.asarray(gain, jnp.float32), s=white.shape)


def squares(corner: Bool[Array, "rows columns"], side: int) -> Bool[Array, "rows columns"]:
    """Return the cells that lie in a square with its highest row and column at a corner.

    Args:
        corner: cells at which a square has its corner; no square reaches in from off the map.
        side: side of a square [cells].
    """
    window = ((0, side - 1), (0, side - 1))
    return jax.lax.reduce_window(corner, False, jax.lax.bitwise_or, (side, side), (1, 1), window)
