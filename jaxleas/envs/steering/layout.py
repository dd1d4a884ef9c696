"""Layouts of the observation: grids of points around the root, and the order of the values."""

import math
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float, Int

from jaxleas.envs.steering.feelers import Feeler
from jaxleas.types import InputError

MOTION_SIZE = 4  # velocity in the root frame (3) and the angle to the goal (1)


@dataclass(frozen=True)
class ObservationLayout:
    """A grid of points around the root, and the order of an observation's values.

    An observation is [velocity x, y, z in the root frame [m/s], angle to the goal [rad], heights
    of the grid points relative to the root [m], clipped], heights row by row from the rearmost to
    the foremost, each row from right (y < 0) to left (y > 0); then, if the layout has them, the
    heights of the profile, from the rearmost point to the foremost, the number of surfaces around
    the root (`surface_count`), and the felt margins (`Feelers`).

    Attributes:
        name: name of the layout, written into exported policies.
        rows: x coordinates of the grid's rows in the root frame, ascending [m].
        columns: y coordinates of the grid's columns in the root frame, ascending and symmetric [m].
        counts_surfaces: whether the observation has the number of surfaces.
        profile: x coordinates of further points in the line ahead, y = 0, ascending [m].
        feelers: moves of the root for which the margin of the conditions is observed.
    """

    name: str
    rows: tuple[float, ...]
    columns: tuple[float, ...]
    counts_surfaces: bool = False
    profile: tuple[float, ...] = ()
    feelers: tuple[Feeler, ...] = ()

    @property
    def points_in_root(self) -> Float[np.ndarray, "points 2"]:
        """The points whose heights are seen, in the root frame [m] and the observation's order."""
        x, y = np.meshgrid(self.rows, self.columns, indexing="ij")
        ahead = np.column_stack([self.profile, np.zeros(len(self.profile))])
        return np.concatenate([np.stack([x.ravel(), y.ravel()], axis=-1), ahead])

    @property
    def size(self) -> int:
        """Number of values in an observation."""
        return MOTION_SIZE + self.heights + self.counts_surfaces + len(self.feelers)

    @property
    def heights(self) -> int:
        """Number of heights in an observation."""
        return len(self.rows) * len(self.columns) + len(self.profile)

    @property
    def mirror_permutation(self) -> Int[np.ndarray, " size"]:
        """Order in which an observation's values reappear when left and right are swapped."""
        heights = np.arange(len(self.rows) * len(self.columns)).reshape(len(self.rows), -1)
        mirrored = [np.arange(MOTION_SIZE), MOTION_SIZE + heights[:, ::-1].ravel()]
        first = self.size - len(self.feelers)
        images = [self.feelers.index((x, -y + 0.0, -turn + 0.0)) for x, y, turn in self.feelers]
        unmoved = np.arange(MOTION_SIZE + heights.size, first)
        return np.concatenate([*mirrored, unmoved, first + np.array(images, dtype=np.int64)])

    @property
    def mirror_sign(self) -> Float[np.ndarray, " size"]:
        """Sign of an observation's values when left and right are swapped: y and angle flip."""
        sign = np.ones(self.size, dtype=np.float32)
        sign[[1, 3]] = -1.0
        return sign


def _cells(step: float, first: int, last: int) -> tuple[float, ...]:
    """Return the centres of cells first..last of width `step`; cell 0 begins at the root."""
    return tuple(round(step * (index + 0.5), 6) for index in range(first, last + 1))


# Each height stands for a cell, and the cells tile the ground with no gap at the root: what counts
# most, whether there is ground under the root, lies between two rows. (Rows at whole steps leave a
# stripe of 0.32 m unseen there, and policies walked over edges that they could not see.)

# T sec. 3.2.2: 7 rows ahead, 3 behind, 7 columns per side, about 110, 50 and 60 cm.
THESIS144 = ObservationLayout(
    name="thesis144",
    rows=(*_cells(0.17, -3, -1), *_cells(0.15, 0, 6)),
    columns=_cells(0.09, -7, 6),
)

# T sec. 5.2.3: the same, and the number of surfaces around the robot, for planners that choose
# surfaces.
THESIS145 = replace(THESIS144, name="thesis145", counts_surfaces=True)

# I sec. III-A: 9 rows ahead, 2 behind, 7 columns across.
ICRA81 = ObservationLayout(
    name="icra81",
    rows=(*_cells(0.20, -2, -1), *_cells(0.08, 0, 8)),
    columns=tuple(round(0.15 * index, 6) for index in range(-3, 4)),
)


def _both_ways(*moves: tuple[float, float]) -> tuple[Feeler, ...]:
    """Return moves ahead and aside [m], each to the right and to the left."""
    return tuple((ahead, side * aside, 0.0) for ahead, aside in moves for side in (-1.0, 1.0))


# Not in the sources. Feelers: ahead to where the root comes to rest and beyond, more sparsely aside
# and behind; turned by as much as brings the trunk's corners against what is beside it.
FEELERS169 = replace(
    THESIS144,
    name="feelers169",
    profile=(-0.03, 0.02, 0.125, 0.175, 0.275, 0.325, 0.425),
    feelers=(
        *((ahead, 0.0, 0.0) for ahead in (0.07, 0.15, 0.25, 0.38)),
        *_both_ways((0.07, 0.07), (0.17, 0.17), (0.0, 0.08), (0.0, 0.20), (-0.1, 0.1)),
        *((-behind, 0.0, 0.0) for behind in (0.08, 0.22)),
        *((0.0, 0.0, turn) for turn in (-math.pi / 9, math.pi / 9)),
    ),
)

_LAYOUTS = {layout.name: layout for layout in (THESIS144, THESIS145, ICRA81, FEELERS169)}

ACTION_SIZE = 4  # acceleration in the root frame (3) and turn rate (1)
MIRROR_ACTION_SIGN = np.array([1.0, -1.0, 1.0, -1.0], dtype=np.float32)


def layout_named(name: str) -> ObservationLayout:
    """Return the observation layout with this name.

    Raises:
        InputError: there is no such layout.
    """
    if name not in _LAYOUTS:
        raise InputError(f"no observation layout is called {name!r}; there are {list(_LAYOUTS)}")
    return _LAYOUTS[name]
