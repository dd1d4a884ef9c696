"""Bounds on the robustness of equilibrium without a linear program."""

import numpy as np
from jaxtyping import Bool, Float

from jaxleas.dynamics.contact_points import ContactPoints
from jaxleas.dynamics.equilibrium import GRAVITY, contact_wrenches
from jaxleas.dynamics.friction import margin_of_generator
from jaxleas.dynamics.vectors import cross

_ROUNDS = 3
_EXCESS = 2.0  # [N]; aim above the bound, so that projecting back does not fall below it
_SIDED = 1e-9  # a generator that turns backwards by less counts as turning forwards


def decide_robustness(
    contacts: ContactPoints,
    com: Float[np.ndarray, "N 3"],
    *,
    mass: float,
    least: float,
) -> tuple[Bool[np.ndarray, " N"], Bool[np.ndarray, " N"]]:
    """Return where the robustness of static equilibrium is certainly at least a bound, or below it.

    From below: any b with G b = m [-g; 0] proves a robustness of min(b) |(sum_j g_j) x g_1|; the
    shortest such b is tried, then some nearer to the bound by alternating projections. From above:
    an axis through two contact points about which no generator turns backwards; the robot tips
    over it if gravity turns it backwards. Where neither answers, use `robustness_of`.

    Args:
        contacts: points of contact, with one batch axis.
        com: centre of mass in the world [m].
        mass: mass of the robot [kg].
        least: bound on the robustness [N].

    Returns:
        Where the robustness is certainly at least the bound, and where it is certainly below it.
    """
    wrenches = contact_wrenches(contacts, com)
    bound = np.broadcast_to(least / margin_of_generator(contacts), len(com))
    weight = mass * GRAVITY
    there = _balances(wrenches, weight, bound) if least >= 0.0 else np.zeros(len(com), dtype=bool)
    missing = np.zeros(len(com), dtype=bool)
    open_ = np.flatnonzero(~there)
    if len(open_):
        arms = contacts.points[open_] - com[open_, None]
        missing[open_] = _tips_over(wrenches[open_], arms, weight, bound[open_])
    return there, missing


def _balances(wrenches: np.ndarray, weight: float, bound: np.ndarray) -> Bool[np.ndarray, " N"]:
    wanted = np.array([0.0, 0.0, weight, 0.0, 0.0, 0.0])
    transposed = wrenches.transpose(0, 2, 1)
    gram = wrenches @ transposed
    # A point or an edge does not span all six dimensions: it proves nothing.
    regular = np.linalg.det(gram) > 1e-9
    gram = np.where(regular[:, None, None], gram, np.eye(6))
    back = transposed @ np.linalg.inv(gram)
    forces = back @ wanted
    proved = forces.min(axis=1) >= bound
    for _ in range(_ROUNDS):
        if (proved | ~regular).all():
            break
        aim = np.maximum(forces, bound[:, None] + _EXCESS)
        missing = wanted - (wrenches @ aim[:, :, None])[:, :, 0]
        forces = aim + (back @ missing[:, :, None])[:, :, 0]
        proved |= forces.min(axis=1) >= bound
    return proved & regular


def _tips_over(
    wrenches: np.ndarray, arms: np.ndarray, weight: float, bound: np.ndarray
) -> Bool[np.ndarray, " N"]:
    """Return where a tipping axis bounds b0 from above by less than `bound`.

    For the axis u through p, relative to the centre of mass, a force f and torque t turn by
    y . [f; t] with y = [p x u; u]. If y . g >= 0 for all generators, then
    b0 <= y . [weight; 0] / y . (sum of generators).
    """
    first, second = np.triu_indices(arms.shape[1], 1)
    start, axis = arms[:, first], arms[:, second] - arms[:, first]
    y = np.concatenate([cross(start, axis), axis], axis=2)  # u . (t - p x f) = u . t + (p x u) . f
    turning = y @ wrenches
    total = turning.sum(axis=2)
    gravity = weight * y[..., 2]
    forward = turning.min(axis=2) >= -_SIDED
    backward = turning.max(axis=2) <= _SIDED
    sign = np.where(forward, 1.0, np.where(backward, -1.0, 0.0))
    strong = sign * total > 1e-6
    limit = np.where(strong, gravity / np.where(strong, total, 1.0), np.inf)
    return limit.min(axis=1) < bound
