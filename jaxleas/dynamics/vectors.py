"""Vector products of small arrays, without the overhead of `np.cross`."""

import numpy as np
from jaxtyping import Float


def cross(
    first: Float[np.ndarray, "*batch 3"], second: Float[np.ndarray, "*batch 3"]
) -> Float[np.ndarray, "*batch 3"]:
    """Return first x second; leading axes broadcast."""
    a, b, c = first[..., 0], first[..., 1], first[..., 2]
    x, y, z = second[..., 0], second[..., 1], second[..., 2]
    product = np.empty((*np.broadcast_shapes(a.shape, x.shape), 3))
    product[..., 0] = b * z - c * y
    product[..., 1] = c * x - a * z
    product[..., 2] = a * y - b * x
    return product
