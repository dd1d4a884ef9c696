"""The one code for "no ground".

On the device it is the finite `NO_GROUND`, so that no NaN can enter the training arithmetic. A
height map on the host has the values of its file, NaN where there is no ground;
`terrain.make_atlas` is the only place that converts one into the other.
"""

from typing import Any

NO_GROUND = -1.0e4
"""Terrain height where there is no ground [m]: far below every robot."""

NO_GROUND_IN_ROOT = 0.01 * NO_GROUND
"""Bound on terrain heights relative to a root [m]: there is no ground at or below it.

`NO_GROUND` minus the z of any root lies far below it, and no leg is as long."""


def is_ground(height: Any) -> Any:
    """Return where there is ground.

    Args:
        height: terrain heights in the world [m], NumPy or JAX, from a height map or an atlas.
    """
    return height > NO_GROUND  # a NaN is not greater
