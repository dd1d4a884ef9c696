"""Static equilibrium: the distance of robots from slipping and tipping over, in batches."""

import numpy as np
from jaxtyping import Float

from jaxleas.dynamics.contact_points import ContactPoints
from jaxleas.dynamics.equilibrium_lp import robustness_by_linear_program
from jaxleas.dynamics.friction import friction_generators, margin_of_generator
from jaxleas.dynamics.small_lp import maximise
from jaxleas.dynamics.vectors import cross
from jaxleas.types import InputError

GRAVITY = 9.81  # standard gravity [m/s^2]
_CERTIFIED = 1e-9  # tolerance of a basis's primal and dual feasibility, relative to its size


def equilibrium_robustness(
    points: Float[np.ndarray, "*batch P 3"],
    normals: Float[np.ndarray, "*batch P 3"],
    com: Float[np.ndarray, "*batch 3"],
    *,
    mass: float,
    friction: float,
    acceleration: Float[np.ndarray, "*batch 3"] | None = None,
) -> Float[np.ndarray, "*batch"]:
    """Return the robustness of equilibrium [N] with four generators that turn with the world.

    `robustness_of` is the same for contacts whose generators turn with them.

    Args:
        points: points of contact in the world [m].
        normals: unit contact normals, away from the ground.
        com: centre of mass in the world [m].
        mass: mass of the robot [kg].
        friction: friction coefficient mu of all points [1].
        acceleration: acceleration of the centre of mass [m/s^2]; None for static equilibrium.

    Raises:
        InputError: shapes disagree, or a number is not finite or out of range.
    """
    contacts = ContactPoints(points, normals, friction)
    return robustness_of(contacts, com, mass=mass, acceleration=acceleration)


def robustness_of(
    contacts: ContactPoints,
    com: Float[np.ndarray, "*batch 3"],
    *,
    mass: float,
    acceleration: Float[np.ndarray, "*batch 3"] | None = None,
) -> Float[np.ndarray, "*batch"]:
    """Return the robustness of equilibrium [N]: positive inside, negative outside.

    With the generators G of all contact points' friction cones, it is b0 |(sum_j g_j) x g_1| for

        max b0  such that  G b = m [a - g; c x (a - g)],  b_i >= b0

    (Del Prete et al. 2016, "Fast algorithms to test robust static equilibrium"; generators of one
    point in the product). The dual of this has one variable fewer than the wrench has dimensions,
    and is solved for the whole batch together. Every answer is certified: its basis must be primal
    and dual feasible. Problems that fail, or in which contacts pull at the robot from above, go to
    HiGHS.

    Args:
        contacts: points of contact.
        com: centre of mass in the world [m].
        mass: mass of the robot [kg].
        acceleration: acceleration of the centre of mass [m/s^2]; None for static equilibrium.

    Raises:
        InputError: shapes disagree, or a number is not finite or out of range.
    """
    _require(contacts, com, mass, acceleration)
    flat, flat_com = contacts.flat(), com.reshape(-1, 3)
    lift = np.array([0.0, 0.0, GRAVITY])
    force = mass * (lift + (0.0 if acceleration is None else acceleration.reshape(-1, 3)))
    force = np.broadcast_to(force, flat_com.shape)
    wrenches = contact_wrenches(flat, flat_com)
    least, certified = _solve(wrenches, force)
    for index in np.flatnonzero(~certified):
        least[index] = robustness_by_linear_program(wrenches[index], force[index])
    return (least * margin_of_generator(flat)).reshape(contacts.batch)


def contact_wrenches(
    contacts: ContactPoints, com: Float[np.ndarray, "N 3"]
) -> Float[np.ndarray, "N 6 G"]:
    """Return the wrench of each generator about the centre of mass: force over torque.

    Args:
        contacts: points of contact, with one batch axis.
        com: centre of mass in the world [m].
    """
    forces = friction_generators(
        contacts.normals, contacts.friction, contacts.ahead, contacts.generators
    )
    arms = (contacts.points - com[:, None])[:, :, None]
    torques = cross(arms, forces)
    count = len(com)
    wrenches = np.concatenate([forces.reshape(count, -1, 3), torques.reshape(count, -1, 3)], axis=2)
    return wrenches.transpose(0, 2, 1)


def _solve(
    wrenches: Float[np.ndarray, "N 6 G"], force: Float[np.ndarray, "N 3"]
) -> tuple[np.ndarray, np.ndarray]:
    """Return b0 [N] of each problem, and whether it is certified.

    Along the direction d of the generators' sum every generator usually has a positive part. The
    equation along d gives b0 = (d . f - sum_j (d . g_j) s_j) / sum_j d . g_j for b = b0 + s; the
    other five remain: A s = r, s >= 0, and b0 is largest where gamma . s is least, gamma > 0.
    """
    frame = _frames_along(wrenches[:, :3].sum(axis=2))
    turned = np.concatenate([frame @ wrenches[:, :3], wrenches[:, 3:]], axis=1)
    wanted = np.concatenate([(frame @ force[:, :, None])[:, :, 0], np.zeros_like(force)], axis=1)
    total = turned.sum(axis=2)
    usable = (turned[:, 0] > 0.0).all(axis=1)
    leading = np.where(usable, total[:, 0], 1.0)
    gamma = turned[:, 0] / leading[:, None]
    share = wanted[:, 0] / leading
    A = turned[:, 1:] - total[:, 1:, None] * gamma[:, None, :]
    r = wanted[:, 1:] - total[:, 1:] * share[:, None]
    # Scale forces to about one: the tolerances of the solver are absolute.
    scale = np.linalg.norm(force, axis=1, keepdims=True)
    scale = np.where(scale > 0.0, scale, 1.0)
    factor = gamma.shape[1]
    answer = maximise(r / scale, A.transpose(0, 2, 1), np.maximum(gamma, 0.0) * factor)
    best, certified = _certify(A, r / scale, gamma * factor, answer.active)
    return share - best * scale[:, 0] / factor, certified & answer.solved & usable


def _certify(
    A: Float[np.ndarray, "N 5 G"],
    r: Float[np.ndarray, "N 5"],
    gamma: Float[np.ndarray, "N G"],
    active: np.ndarray,
) -> tuple[np.ndarray, np.ndarray]:
    """Solve again on each final basis, and check primal and dual feasibility."""
    whole = np.all(active >= 0, axis=1)
    basis = np.where(active >= 0, active, 0)
    columns = np.take_along_axis(A, basis[:, None, :], axis=2)  # [N, 5, 5]
    columns = np.where(whole[:, None, None], columns, np.eye(5))
    regular = np.abs(np.linalg.det(columns)) > 1e-14
    columns = np.where(regular[:, None, None], columns, np.eye(5))
    costs = np.take_along_axis(gamma, basis, axis=1)
    y = np.linalg.solve(columns.transpose(0, 2, 1), costs[:, :, None])
    s = np.linalg.solve(columns, r[:, :, None])[:, :, 0]
    reduced = gamma - (y.transpose(0, 2, 1) @ A)[:, 0]
    tolerance = 10 * _CERTIFIED * (1.0 + np.abs(s).max(axis=1))
    primal = s.min(axis=1) >= -tolerance
    dual = reduced.min(axis=1) >= -1e2 * _CERTIFIED * (1.0 + np.abs(y[:, :, 0]).max(axis=1))
    return (costs * s).sum(axis=1), whole & regular & primal & dual


def _frames_along(direction: Float[np.ndarray, "N 3"]) -> Float[np.ndarray, "N 3 3"]:
    """Return rotations whose first row points along each direction."""
    length = np.linalg.norm(direction, axis=1, keepdims=True)
    first = np.where(length > 1e-9, direction / np.maximum(length, 1e-9), [0.0, 0.0, 1.0])
    helper = np.eye(3)[np.abs(first).argmin(axis=1)]
    second = cross(first, helper)
    second /= np.linalg.norm(second, axis=1, keepdims=True)
    return np.stack([first, second, cross(first, second)], axis=1)


def _require(
    contacts: ContactPoints, com: np.ndarray, mass: float, acceleration: np.ndarray | None
) -> None:
    if com.shape != (*contacts.batch, 3):
        raise InputError(
            f"points {contacts.points.shape} and centre of mass {com.shape} do not belong together:"
            " give [..., P, 3] and [..., 3]"
        )
    if acceleration is not None and acceleration.shape != com.shape:
        raise InputError(
            f"acceleration {acceleration.shape} must have the shape of the centre of mass, "
            f"{com.shape}"
        )
    arrays = [com, *([] if acceleration is None else [acceleration])]
    if not all(np.isfinite(array).all() for array in arrays):
        raise InputError("the centre of mass and its acceleration must be finite numbers")
    if not (np.isfinite(mass) and mass > 0.0):
        raise InputError(f"mass {mass} kg must be a positive number")
