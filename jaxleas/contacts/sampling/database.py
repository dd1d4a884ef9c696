"""25,000 configurations of each kind of leg, drawn once and searched at every step (T 4.1.2)."""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from jaxtyping import Float, Int

from jaxleas.dynamics import cross
from jaxleas.robots import LimbModel, Robot, chain_jacobian, legs_of

_TILTS = np.deg2rad([[0.0, 0.0], [12.0, 0.0], [-12.0, 0.0], [0.0, 12.0], [0.0, -12.0]])


@dataclass(frozen=True, eq=False)
class LegDatabase:
    """Configurations of a leg whose foot can be laid on walkable ground, by height.

    Attributes:
        model: model of the leg that has these configurations.
        drawn: number of configurations drawn, including those of no use on walkable ground.
        angles: joint angles [rad].
        soles: positions of the soles in the root frame, in order of z [m].
        rotations: rotations of the feet in the root frame.
        manipulability: |det J|, as a share of the largest one.
        translation: J_v J_v^T of the sole's Jacobian [m^2], for the EFORT score.
        reach: largest horizontal distance of a sole from the root [m].
        heights: z of the soles, ascending [m].
        homogeneous: the soles as columns (x, y, z, 1).
    """

    model: LimbModel
    drawn: int
    angles: Float[np.ndarray, "N J"]
    soles: Float[np.ndarray, "N 3"]
    rotations: Float[np.ndarray, "N 3 3"]
    manipulability: Float[np.ndarray, " N"]
    translation: Float[np.ndarray, "N 3 3"]
    reach: float
    heights: Float[np.ndarray, " N"]
    homogeneous: Float[np.ndarray, "4 N"]

    def __len__(self) -> int:
        """Return the number of configurations kept."""
        return len(self.angles)


@dataclass(frozen=True, eq=False)
class LegDatabases:
    """The configurations of all kinds of legs of a robot.

    Samples are counted through all of them: those of the second data base follow the first one's.

    Attributes:
        each: data base of each model; legs that are mirror images share theirs.
        first: number of the first sample of each.
        soles: positions of all samples' soles, in the root frame [m].
        rotations: rotations of all samples' feet, in the root frame.
    """

    each: tuple[LegDatabase, ...]
    first: Int[np.ndarray, " M"]
    soles: Float[np.ndarray, "N 3"]
    rotations: Float[np.ndarray, "N 3 3"]


@lru_cache(maxsize=4)
def leg_databases(robot: Robot, samples: int, seed: int) -> LegDatabases:
    """Return the data bases of a robot's legs, made once for each process.

    Args:
        robot: robot whose file describes its legs.
        samples: number of configurations to draw for each kind of leg.
        seed: seed of the draw.
    """
    each = tuple(make_database(model, samples, seed) for model in legs_of(robot).models)
    length = np.array([len(database) for database in each])
    return LegDatabases(
        each=each,
        first=np.cumsum(length) - length,
        soles=np.concatenate([database.soles for database in each]),
        rotations=np.concatenate([database.rotations for database in each]),
    )


def make_database(model: LimbModel, samples: int, seed: int) -> LegDatabase:
    """Draw configurations uniformly within the joint limits; the first is the reference.

    Those are kept whose foot, in its place, can be laid on ground within 12 degrees of level by the
    smallest rotation without leaving the joint limits: no others pass the projection later.

    Args:
        model: model of the leg.
        samples: number of configurations to draw.
        seed: seed of the draw.
    """
    chain = model.chain
    angles = np.random.default_rng(seed).uniform(chain.lower, chain.upper, (samples, len(chain)))
    angles[0] = model.reference
    posture = model.posture(angles)
    usable = np.zeros(samples, dtype=bool)
    for x, y in _TILTS:
        normal = np.array([np.sin(x), np.sin(y), 0.0])
        normal[2] = np.sqrt(1.0 - normal @ normal)
        aligned = align(posture.tip_rotation, np.broadcast_to(normal, (samples, 3)))
        usable |= model.inverse(posture.tip, aligned, angles)[1]
    kept = np.flatnonzero(usable)
    kept = kept[np.argsort(posture.tip[kept, 2], kind="stable")]
    jacobian = chain_jacobian(chain, model.posture(angles[kept]))
    manipulability = _manipulability(jacobian)
    linear = jacobian[:, :3]
    soles = posture.tip[kept]
    return LegDatabase(
        model=model,
        drawn=samples,
        angles=angles[kept],
        soles=soles,
        rotations=posture.tip_rotation[kept],
        manipulability=manipulability / max(float(manipulability.max(initial=0.0)), 1e-12),
        translation=linear @ linear.transpose(0, 2, 1),
        reach=float(np.linalg.norm(soles[:, :2], axis=1).max(initial=0.0)),
        heights=soles[:, 2].copy(),
        homogeneous=np.concatenate([soles.T, np.ones((1, len(soles)))]),
    )


def _manipulability(jacobian: Float[np.ndarray, "N 6 J"]) -> Float[np.ndarray, " N"]:
    """Return |det J|, or sqrt(det(J^T J)) of legs with fewer than six joints."""
    if jacobian.shape[2] == 6:
        return np.abs(np.linalg.det(jacobian))
    gram = jacobian.transpose(0, 2, 1) @ jacobian
    return np.sqrt(np.maximum(np.linalg.det(gram), 0.0))


def align(
    rotations: Float[np.ndarray, "N 3 3"], normals: Float[np.ndarray, "N 3"]
) -> Float[np.ndarray, "N 3 3"]:
    """Turn each rotation by the smallest angle that brings its third column to a normal.

    R' = (I + [v] + [v]^2 / (1 + m . n)) R with v = m x n, m the third column.
    """
    columns = rotations.transpose(0, 2, 1)  # rows are now the columns
    third = columns[:, 2]
    cosine = (third * normals).sum(axis=1)[:, None, None]
    v = cross(third, normals)[:, None]
    once = cross(v, columns)
    twice = cross(v, once)
    return (columns + once + twice / np.maximum(1.0 + cosine, 1e-9)).transpose(0, 2, 1)
