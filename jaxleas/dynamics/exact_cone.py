"""The robustness of one equilibrium with the exact, second-order friction cone.

A cone of K generators lies inside the exact one, so that a linear program over generators bounds
the exact robustness from below. Its dual gives the force of the exact cone that would help most, in
closed form; that force becomes a new generator, until none helps any more (Kelley 1960, columns
instead of cuts). The file shares no code with `equilibrium.py`.
"""

import math

import numpy as np
from jaxtyping import Float
from scipy.optimize import linprog

from jaxleas.dynamics.contact_points import ContactPoints
from jaxleas.types import InputError, JaxleasError

_GRAVITY = 9.81  # [m/s^2]
_AT_FIRST = 8  # generators of each point
_HELPS = 1e-9  # a force that improves the robustness by less, in units of the weight, does not help
_MOST_ROUNDS = 100


def exact_robustness(
    contacts: ContactPoints,
    com: Float[np.ndarray, " 3"],
    *,
    mass: float,
    enough: float = math.inf,
) -> float:
    """Return the robustness of one static equilibrium with exact friction cones [N].

    It is the largest r such that forces f_i exist with

        sum_i f_i = -m g,  sum_i (p_i - c) x f_i = 0,  f_i - (r / sin a_i) n_i in cone i,

    where tan a_i = mu_i: every force keeps a distance of r from the boundary of its cone's shift,
    as with generators. Never less than `robustness_of` with any number of generators.

    Args:
        contacts: points of contact of one robot; `generators` does not matter.
        com: centre of mass in the world [m].
        mass: mass of the robot [kg].
        enough: sufficient robustness [N]: a lower bound that reaches it is returned at once.

    Returns:
        The robustness, or a lower bound of at least `enough`; minus infinity where no forces
        balance the weight at any robustness, infinity where squeezing harder always helps.

    Raises:
        InputError: the contacts are a batch, or a number is not finite or out of range.
        JaxleasError: HiGHS found no answer.
    """
    _require(contacts, com, mass)
    frames, arms, friction = _frames(contacts), contacts.points - com, _friction(contacts)
    weight = mass * _GRAVITY
    angles = np.arange(_AT_FIRST) * (2.0 * np.pi / _AT_FIRST)
    around = np.stack([np.cos(angles), np.sin(angles), np.zeros(_AT_FIRST)], axis=1)
    tangents = np.einsum("pij,kj->pki", frames, around)
    forces = frames[:, None, :, 2] + friction[:, None, None] * tangents
    columns = _wrenches(np.repeat(arms, _AT_FIRST, axis=0), forces.reshape(-1, 3))
    sine = friction / np.sqrt(1.0 + friction * friction)
    reserve = _wrenches(arms, frames[:, :, 2] / sine[:, None]).sum(axis=0)
    best = -math.inf
    for _ in range(_MOST_ROUNDS):
        best, multipliers = _solve(columns, reserve)
        if not math.isfinite(best) or best * weight >= enough:
            break
        gain, forces = _most_helpful(multipliers, frames, arms, friction)
        helpful = gain > _HELPS
        if not helpful.any():
            break
        columns = np.concatenate([columns, _wrenches(arms[helpful], forces[helpful])])
    return best * weight


def _solve(
    columns: Float[np.ndarray, "G 6"], reserve: Float[np.ndarray, " 6"]
) -> tuple[float, Float[np.ndarray, " 6"]]:
    """Return max r with sum_j b_j w_j + r s = (weight, 0), b >= 0, and its multipliers."""
    lift = np.array([0.0, 0.0, 1.0, 0.0, 0.0, 0.0])
    count = len(columns)
    answer = linprog(
        np.append(np.zeros(count), -1.0),
        A_eq=np.column_stack([columns.T, reserve]),
        b_eq=lift,
        bounds=[(0, None)] * count + [(None, None)],
        method="highs",
        options={"primal_feasibility_tolerance": 1e-10, "dual_feasibility_tolerance": 1e-10},
    )
    if answer.status == 2:
        return -math.inf, lift
    if answer.status == 3:
        return math.inf, lift
    if answer.status != 0:
        raise JaxleasError(f"HiGHS could not decide an equilibrium: {answer.message}")
    return float(answer.x[-1]), answer.eqlin.marginals


def _most_helpful(
    multipliers: np.ndarray, frames: np.ndarray, arms: np.ndarray, friction: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return, for each point, the force n + mu u of its exact cone that helps most, and how much.

    A force f at the arm a changes the objective by y . (f; a x f) = (y_f + y_t x a) . f, which is
    largest for the unit tangent u along the tangential part of y_f + y_t x a.
    """
    slope = multipliers[:3] + np.cross(multipliers[3:], arms)
    local = np.einsum("pij,pi->pj", frames, slope)
    length = np.linalg.norm(local[:, :2], axis=1)
    along = np.where(length[:, None] > 0.0, local[:, :2] / np.maximum(length, 1e-300)[:, None], 0.0)
    force = np.column_stack([friction[:, None] * along, np.ones(len(arms))])
    return local[:, 2] + friction * length, np.einsum("pij,pj->pi", frames, force)


def _wrenches(
    arms: Float[np.ndarray, "G 3"], forces: Float[np.ndarray, "G 3"]
) -> Float[np.ndarray, "G 6"]:
    return np.concatenate([forces, np.cross(arms, forces)], axis=1)


def _frames(contacts: ContactPoints) -> Float[np.ndarray, "P 3 3"]:
    """Return a frame at each point: two tangents and the normal."""
    normals = contacts.normals
    anyhow = np.eye(3)[np.abs(normals).argmin(axis=1)]
    across = np.cross(normals, anyhow if contacts.ahead is None else contacts.ahead)
    length = np.linalg.norm(across, axis=1, keepdims=True)
    if (length < 1e-6).any():
        raise InputError("the first axis of a contact must not point along its normal")
    across = across / length
    return np.stack([np.cross(across, normals), across, normals], axis=2)


def _friction(contacts: ContactPoints) -> Float[np.ndarray, " P"]:
    return np.broadcast_to(np.asarray(contacts.friction, np.float64), len(contacts.points)).copy()


def _require(contacts: ContactPoints, com: np.ndarray, mass: float) -> None:
    if contacts.batch or com.shape != (3,):
        raise InputError(
            f"give the points of one robot [P, 3] and its centre of mass [3], not"
            f" {contacts.points.shape} and {com.shape}"
        )
    if not (np.isfinite(com).all() and np.isfinite(mass) and mass > 0.0):
        raise InputError("the centre of mass must be finite, and the mass a positive number [kg]")
