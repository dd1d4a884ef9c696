"""Samples of the data base that come close to a surface from a root pose (T 4.1.2)."""

from dataclasses import dataclass, fields, replace
from itertools import pairwise

import numpy as np
from jaxtyping import Float, Int

from jaxleas.contacts.sampling.case import PlanningCase
from jaxleas.contacts.sampling.database import LegDatabase
from jaxleas.contacts.sampling.heuristics import HEURISTICS, Wish
from jaxleas.contacts.sampling.roots import Roots, to_model


@dataclass(frozen=True)
class Aim:
    """The aim of the moving leg of each robot.

    Attributes:
        roots: root poses of the robots.
        limb: index of the leg that moves.
        target: reference foot under the root some time ahead, in the root frame, mirrored where
            the leg mirrors its model [m].
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
        sample: number of the sample in the data bases.
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
    every = np.arange(len(aim))
    parts = []
    for number, rows in case.legs.by_model(aim.limb):
        found = _of_model(case, aim[rows], number)
        parts.append(replace(found, row=every[rows][found.row]))
    if len(parts) == 1:
        return parts[0]
    together = Candidates(*(
        np.concatenate([getattr(part, each.name) for part in parts]) for each in fields(Candidates)
    ))  # fmt: skip
    return together[np.argsort(together.row, kind="stable")]


def _of_model(case: PlanningCase, aim: Aim, number: int) -> Candidates:
    """Return the candidates of legs that have one model."""
    database = case.databases.each[number]
    row, sample, surface = _near_pairs(case, aim, database)
    wish = Wish(sample, aim.target[row], aim.direction[row], case.ground.normals[surface])
    score = HEURISTICS[case.settings.heuristic](database, wish)
    bounds = np.searchsorted(row, np.arange(len(aim) + 1))
    orders, ranks = [], []
    for first, last in pairwise(bounds):
        order = np.argsort(-score[first:last], kind="stable")[: sum(case.settings.stages)]
        orders.append(order + first)
        ranks.append(np.arange(len(order)))
    order = np.concatenate(orders)
    counted = sample[order] + case.databases.first[number]
    return Candidates(row[order], np.concatenate(ranks), counted, surface[order])


def _near_pairs(
    case: PlanningCase, aim: Aim, database: LegDatabase
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return (row, sample, surface) of all samples within reach of a surface, row after row.

    A slice of samples times a few half-spaces, one surface at a time: gathering the samples of all
    surfaces into one array costs more than this loop.
    """
    ground = case.ground
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
    """Return rows (a, c) for soles x as the legs' model has them: near where a . x + c >= 0.

    Two sides of the plane at the contact distance, then the edges.
    """
    ground, gap = case.ground, case.settings.contact_distance
    roots, side = aim.roots[row], case.legs.side[aim.limb[row]]
    normals = np.concatenate(
        [ground.normals[surface, None], -ground.normals[surface, None], ground.inward[surface]],
        axis=1,
    )
    offsets = ground.offsets[surface, None]
    least = np.concatenate([offsets - gap, -offsets - gap, ground.inward_offsets[surface]], axis=1)
    constant = (normals @ roots.position[:, :, None])[:, :, 0] - least
    faces = normals.shape[1]
    turned = to_model(normals.reshape(-1, 3), np.repeat(roots.yaw, faces), np.repeat(side, faces))
    return np.concatenate([turned.reshape(normals.shape), constant[:, :, None]], axis=2)
