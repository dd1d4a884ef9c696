"""Ground forces within their friction cones that come nearest to a wanted wrench."""

import numpy as np
from jaxtyping import Bool, Float

from jaxleas.controllers.stance import grasp_of

SMALL = 1e-3
"""Weight of the forces' size against the wrench's error."""
IMPORTANCE = np.array([1.0, 1.0, 2.0, 6.0, 6.0, 2.0])
"""Weights of the wrench's parts: force [1/N], moment [1/(N m)]; falling over is worst."""


def cone_forces(
    wrench: Float[np.ndarray, "N 6"],
    arms: Float[np.ndarray, "N E 3"],
    stands: Bool[np.ndarray, "N E"],
    friction: float,
    least: float,
) -> Float[np.ndarray, "N E 3"]:
    """Return the forces on standing feet that minimise |W (A f - w)|^2 + eps |f|^2 in the cones.

    Where the minimum without cones lies inside them it is the answer, for all robots at once;
    elsewhere forces are combined of the four edges of a pyramid within each cone, by the method
    of Lawson and Hanson for non-negative least squares.

    Args:
        wrench: force [N] and moment about the centre of mass [Nm].
        arms: positions of the feet relative to the centre of mass, in the axes of the wrench [m].
        stands: whether a foot stands.
        friction: friction coefficient of the ground.
        least: least normal force of a standing foot, which keeps its contact [N].
    """
    grasp = IMPORTANCE[:, None] * grasp_of(arms, stands)
    wanted = IMPORTANCE * wrench
    turned = np.swapaxes(grasp, 1, 2)
    square = grasp @ turned + SMALL * np.eye(6)
    dual = np.linalg.solve(square, wanted[..., None])
    forces = (turned @ dual)[..., 0].reshape(arms.shape)
    along = np.hypot(forces[..., 0], forces[..., 1])
    held = (forces[..., 2] >= least) & (along <= friction * forces[..., 2])
    for robot in np.flatnonzero((stands & ~held).any(axis=1)):
        forces[robot] = _on_edges(grasp[robot], wanted[robot], stands[robot], friction, least)
    return forces


def _on_edges(
    grasp: Float[np.ndarray, "6 F"],
    wanted: Float[np.ndarray, "6"],
    stands: Bool[np.ndarray, " E"],
    friction: float,
    least: float,
) -> Float[np.ndarray, "E 3"]:
    """Return the forces of one robot as combinations of the edges of their pyramids."""
    from scipy.optimize import nnls

    forces = np.zeros((len(stands), 3))
    forces[stands, 2] = least
    feet = np.flatnonzero(stands)
    if not len(feet):
        return forces
    sides = friction * np.array([[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]])
    edges = np.concatenate([sides, np.ones((4, 1))], axis=1)
    spread = np.zeros((len(stands) * 3, 4 * len(feet)))
    for place, foot in enumerate(feet):
        spread[3 * foot : 3 * foot + 3, 4 * place : 4 * place + 4] = edges.T
    rows = np.concatenate([grasp @ spread, np.sqrt(SMALL) * spread])
    base = forces.reshape(-1)
    aims = np.concatenate([wanted - grasp @ base, -np.sqrt(SMALL) * base])
    shares, _ = nnls(rows, aims)
    return (base + spread @ shares).reshape(forces.shape)
