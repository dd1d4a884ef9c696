"""Order of the candidates: the four scores of the published planner."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int

from jaxleas.contacts.sampling.database import LegDatabase

STATIC_SHARE = 0.1
"""Weight of the manipulability in the fixed-step score."""


@dataclass(frozen=True)
class Wish:
    """Input of a score, one row per candidate, in the root frame.

    Vectors are mirrored where a leg mirrors its model.

    Attributes:
        sample: index of the candidate's sample in the data base.
        target: the reference foot under the root some time ahead [m].
        direction: unit vector of the root's motion; zero at standstill.
        normal: normal of the surface.
    """

    sample: Int[np.ndarray, " N"]
    target: Float[np.ndarray, "N 3"]
    direction: Float[np.ndarray, "N 3"]
    normal: Float[np.ndarray, "N 3"]


Score = Callable[[LegDatabase, Wish], Float[np.ndarray, " N"]]


def fixed_step(database: LegDatabase, wish: Wish) -> Float[np.ndarray, " N"]:
    """Return 1 - |effector - target|^2 + 0.1 manipulability (the default)."""
    offset = database.soles[wish.sample] - wish.target
    distance = (offset * offset).sum(axis=1)
    return 1.0 - distance + STATIC_SHARE * database.manipulability[wish.sample]


def manipulability(database: LegDatabase, wish: Wish) -> Float[np.ndarray, " N"]:
    """Return |det J| as a share of the data base's largest (Yoshikawa 1985)."""
    return database.manipulability[wish.sample]


def effort(database: LegDatabase, wish: Wish) -> Float[np.ndarray, " N"]:
    """Return EFORT, (d^T J J^T d) n_z: push along the motion, from level ground (Tonneau 2014)."""
    ellipsoid = database.translation[wish.sample]
    pushed = (ellipsoid @ wish.direction[:, :, None])[:, :, 0]
    return (pushed * wish.direction).sum(axis=1) * wish.normal[:, 2]


def reference(database: LegDatabase, wish: Wish) -> Float[np.ndarray, " N"]:
    """Return minus the distance of the joint angles from the reference posture [rad]."""
    return -np.linalg.norm(database.angles[wish.sample] - database.model.reference, axis=1)


HEURISTICS: dict[str, Score] = {
    "fixed_step": fixed_step,
    "manipulability": manipulability,
    "effort": effort,
    "reference": reference,
}
