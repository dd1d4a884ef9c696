"""The point of a polytope nearest to the origin (Lawson and Hanson 1974, problem LDP).

HiGHS' own quadratic solver ended with "solve error" on some of these problems.
"""

import numpy as np
from jaxtyping import Float
from scipy.optimize import nnls


def least_distance(
    G: Float[np.ndarray, "m n"], h: Float[np.ndarray, " m"]
) -> Float[np.ndarray, " n"] | None:
    """Return argmin |u| over G u <= h, or None for numerical trouble.

    The dual is a non-negative least-squares problem: with E = [-G'; -h'] and f = (0, ..., 0, 1),
    the residual r = E y - f of its solution y gives u = -r_1..n / r_n+1.

    Args:
        G: unit rows; {u : G u <= h} must not be empty.
        h: bounds of the rows [m].
    """
    size = G.shape[1]
    E = -np.concatenate([G, h[:, None]], axis=1).T
    f = np.append(np.zeros(size), 1.0)
    try:
        y, _ = nnls(E, f, maxiter=30 * size + 100)
    except RuntimeError:  # too many iterations
        return None
    residual = E @ y - f
    if residual[-1] > -1e-12:
        return None
    return -residual[:-1] / residual[-1]
