"""A robustness that is surely there: a lower bound without a linear program."""

import numpy as np
from jaxtyping import Bool, Float

from jaxleas.dynamics.equilibrium import GRAVITY, contact_wrenches
from jaxleas.dynamics.friction import margin_of_generator

_ROUNDS = 3
_EXCESS = 2.0  # aim past the bound, so that projecting back does not fall short of it


def is_surely_robust(
    points: Float[np.ndarray, "N P 3"],
    normals: Float[np.ndarray, "N P 3"],
    com: Float[np.ndarray, "N 3"],
    *,
    mass: float,
    friction: float,
    least: float,
) -> Bool[np.ndarray, " N"]:
    """Tell where the robustness of static equilibrium is certainly `least` or more.

    Any b with G b = m [-g; 0] proves a robustness of min(b) |(sum_j g_j) x g_1|. The shortest such
    b is tried, then some nearer to the bound by alternating projections. Where none suffices
    nothing is known: ask `equilibrium_robustness`.

    Args:
        points: of contact, in the world [m].
        normals: at the points.
        com: centre of mass [m].
        mass: of the robot [kg].
        friction: mu [1].
        least: the bound [N].
    """
    wrenches = contact_wrenches(points, normals, com, friction)
    wanted = np.array([0.0, 0.0, mass * GRAVITY, 0.0, 0.0, 0.0])
    transposed = wrenches.transpose(0, 2, 1)
    gram = wrenches @ transposed
    # A point or an edge does not span all six dimensions: nothing is proved there.
    regular = np.linalg.det(gram) > 1e-9
    gram = np.where(regular[:, None, None], gram, np.eye(6))
    back = transposed @ np.linalg.inv(gram)
    bound = least / margin_of_generator(friction)
    forces = back @ wanted
    proved = forces.min(axis=1) >= bound
    for _ in range(_ROUNDS):
        if (proved | ~regular).all():
            break
        aim = np.maximum(forces, _EXCESS * bound)
        missing = wanted - (wrenches @ aim[:, :, None])[:, :, 0]
        forces = aim + (back @ missing[:, :, None])[:, :, 0]
        proved |= forces.min(axis=1) >= bound
    return proved & regular
