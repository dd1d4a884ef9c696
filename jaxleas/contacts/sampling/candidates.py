"""Which samples of the data base come close to a surface from a root pose? (T 4.1.2)"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int

from jaxleas.contacts.sampling.heuristics import HEURISTICS, Wish
from jaxleas.contacts.sampling.limbs import SIDES, Roots, to_world
from jaxleas.contacts.sampling.world import World


@dataclass(frozen=True)
class Aim:
    """What the moving leg of each robot is wanted to do.

    Attributes:
        roots: where the robots are.
        limb: that moves: 0 left, 1 right.
        target: the reference foot under the root some time ahead, mirrored to the left leg, in
            the root frame [m].
        direction: of the root's motion likewise, unit or zero.
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
        row: of the aim.
        rank: 0 is the best of its row.
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


def near_candidates(world: World, aim: Aim) -> Candidates:
    """Return every sample near a surface, each row's best score first.

    The samples lie in order of height: a surface's interval of heights below the root picks a
    slice, of which the plane and the edges then choose.

    Args:
        world: robot, scene, settings.
        aim: one row a robot.
    """
    row, sample, surface = _slices(world, aim.roots)
    database, ground = world.database, world.ground
    yaw, side = aim.roots.yaw[row], SIDES[aim.limb[row]]
    soles = to_world(database.soles[sample], yaw, side) + aim.roots.position[row]
    distance = (ground.normals[surface] * soles).sum(axis=1) - ground.offsets[surface]
    near = np.flatnonzero(np.abs(distance) <= world.settings.contact_distance)
    near = near[ground.inside(soles[near], surface[near])]
    row, sample, surface = row[near], sample[near], surface[near]
    wish = Wish(sample, aim.target[row], aim.direction[row], ground.normals[surface])
    score = HEURISTICS[world.settings.heuristic](database, wish)
    order = np.lexsort((-score, row))
    row, sample, surface = row[order], sample[order], surface[order]
    first = np.searchsorted(row, np.arange(len(aim)))
    return Candidates(row, np.arange(len(row)) - first[row], sample, surface)


def _slices(world: World, roots: Roots) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return (row, sample, surface) of all samples in the heights of all surfaces near a root."""
    ground, database = world.ground, world.database
    count, gap = ground.walkable, world.settings.contact_distance
    reach = database.reach + gap
    x, y = roots.position[:, 0, None], roots.position[:, 1, None]
    near = (ground.low[:count, 0] <= x + reach) & (ground.high[:count, 0] >= x - reach)
    near &= (ground.low[:count, 1] <= y + reach) & (ground.high[:count, 1] >= y - reach)
    row, surface = np.nonzero(near)
    height = roots.position[row, 2]
    heights = database.soles[:, 2]
    first = np.searchsorted(heights, ground.low[surface, 2] - height - gap)
    last = np.searchsorted(heights, ground.high[surface, 2] - height + gap)
    length = np.maximum(last - first, 0)
    end = np.cumsum(length)
    which = np.repeat(np.arange(len(row)), length)
    sample = np.arange(end[-1] if len(end) else 0) - (end - length)[which] + first[which]
    return row[which], sample, surface[which]
