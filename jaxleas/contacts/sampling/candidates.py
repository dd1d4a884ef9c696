"""Samples of the data base that come close to a surface from a root pose (T 4.1.2)."""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from jaxtyping import Float, Int

from jaxleas.contacts.sampling.case import PlanningCase
from jaxleas.contacts.sampling.heuristics import HEURISTICS, Wish
from jaxleas.contacts.sampling.limbs import SIDES, Roots, to_left_root


@dataclass(frozen=True)
class Aim:
    """The aim of the moving leg of each robot.

    Attributes:
        roots: root poses of the robots.
        limb: index of the limb that moves: 0 left, 1 right.
        target: reference foot under the root some time ahead, mirrored to the left leg, in the
            root frame [m].
        direction: direction of the root's motion, mirrored likewise; a unit vector or zero.
    """

    roots: Roots
    limb: Int[np.ndarray, " N"]
    target: Float[np.ndarray, "N 3"]
    direction: Float[np.ndarray, "N 3"]

    def __getitem__(self, rows) -> "Aim":
        """Return some of the rows."""
        return Aim(self.roots[rows], self.limb[rows], self.target[rows], self.direction[rows])

    def __len__(self) -> int:
        """Return the number of robots."""
        return len(self.limb)


@dataclass(frozen=True)
class Candidates:
    """Pairs of a sample and a surface, by robot and score.

    Attributes:
        row: row of the aim.
        rank: rank of the candidate; 0 is the best of its row.
        sample: index in the data base.
        surface: index of the ground's polygon.
    """

    row: Int[np.ndarray, " M"]
    rank: Int[np.ndarray, " M"]
    sample: Int[np.ndarray, " M"]
    surface: Int[np.ndarray, " M"]

    def __getitem__(self, which) -> "Candidates":
        """Return some of the candidates."""
        return Candidates(
            self.row[which], self.rank[which], self.sample[which], self.surface[which]
        )

    def __len__(self) -> int:
        """Return the number of candidates."""
        return len(self.row)


def near_candidates(case: PlanningCase, aim: Aim) -> Candidates:
    """Return the samples near a surface, each row's best scores first.

    The samples lie in order of height: a surface's interval of heights below the root picks a
    slice, of which the plane and the edges then select. At most as many per row are returned as are
    ever tried.

    Args:
        case: robot, scene, settings.
        aim: aim of the moving legs, one row per robot.
    """
    row, sample, surface = _near_pairs(case, aim)
    wish = Wish(sample, aim.target[row], aim.direction[row], case.ground.normals[surface])
    score = HEURISTICS[case.settings.heuristic](case.database, wish)
    bounds = np.searchsorted(row, np.arange(len(aim) + 1))
    orders, ranks = [], []
    for first, last in pairwise(bounds):
        order = np.argsort(-score[first:last], kind="stable")[: sum(case.settings.stages)]
        orders.append(order + first)
        ranks.append(np.arange(len(order)))
    order = np.concatenate(orders)
    return Candidates(row[order], np.concatenate(ranks), sample[order], surface[order])


def _near_pairs(case: PlanningCase, aim: Aim) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return (row, sample, surface) of all samples within reach of a surface, row after row.

    A slice of samples times a few half-spaces, one surface at a time: gathering the samples of all
    surfaces into one array costs more than this loop.
    """
    ground, database = case.ground, case.database
    count, gap = ground.walkable, case.settings.contact_distance
    position = aim.roots.position
    reach = database.reach + gap
    x, y = position[:, 0, None], position[:, 1, None]
    near = (ground.low[:count, 0] <= x + reach) & (ground.high[:count, 0] >= x - reach)
    near &= (ground.low[:count, 1] <= y + reach) & (ground.high[:count, 1] >= y - reach)
    near &= ground.scene[:count] == aim.roots.scene[:, None]
    row, surface = np.nonzero(near)
    first = np.searchsorted(
        database.heights, ground.low[surface, 2] - position[row, 2] - gap
    ).tolist()
    last = np.searchsorted(
        database.heights, ground.high[surface, 2] - position[row, 2] + gap
    ).tolist()
    halfspaces = _halfspaces(case, aim, row, surface)
    found = [
        first[pair]
        + np.flatnonzero(
            (halfspaces[pair] @ database.homogeneous[:, first[pair] : last[pair]] >= 0.0).all(
                axis=0
            )
        )
        for pair in range(len(row))
    ]
    length = [len(each) for each in found]
    sample = np.concatenate(found) if found else np.zeros(0, dtype=np.int64)
    return np.repeat(row, length), sample, np.repeat(surface, length)


def _halfspaces(
    case: PlanningCase, aim: Aim, row: np.ndarray, surface: np.ndarray
) -> Float[np.ndarray, "pairs H 4"]:
    """Return, for left-leg soles in the root frame, rows (a, c): near where a . x + c >= 0.

    Two sides of the plane at the contact distance, then the edges.
    """
    ground, gap = case.ground, case.settings.contact_distance
    roots, side = aim.roots[row], SIDES[aim.limb[row]]
    normals = np.concatenate(
        [ground.normals[surface, None], -ground.normals[surface, None], ground.inward[surface]],
        axis=1,
    )
    offsets = ground.offsets[surface, None]
    least = np.concatenate([offsets - gap, -offsets - gap, ground.inward_offsets[surface]], axis=1)
    constant = (normals @ roots.position[:, :, None])[:, :, 0] - least
    faces = normals.shape[1]
    turned = to_left_root(
        normals.reshape(-1, 3), np.repeat(roots.yaw, faces), np.repeat(side, faces)
    )
    return np.concatenate([turned.reshape(normals.shape), constant[:, :, None]], axis=2)
