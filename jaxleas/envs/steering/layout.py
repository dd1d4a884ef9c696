"""Layouts of the observation: grids of points around the root, and the order of the values."""

from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float, Int

from jaxleas.types import InputError

MOTION_SIZE = 4  # velocity in the root frame (3) and the angle to the goal (1)


@dataclass(frozen=True)
class ObservationLayout:
    """A grid of points around the root, and the order of an observation's values.

    An observation is [velocity x, y, z in the root frame [m/s], angle to the goal [rad], heights
    of the grid points relative to the root [m], clipped], heights row by row from the rearmost to
    the foremost, each row from right (y < 0) to left (y > 0); then, if the layout has it, the
    number of surfaces around the root (`surface_count`).

    Attributes:
        name: name of the layout, written into exported policies.
        rows: x coordinates of the grid's rows in the root frame, ascending [m].
        columns: y coordinates of the grid's columns in the root frame, ascending and symmetric [m].
        counts_surfaces: whether the observation has the number of surfaces.
    """

    name: str
    rows: tuple[float, ...]
    columns: tuple[float, ...]
    counts_surfaces: bool = False

    @property
    def points_in_root(self) -> Float[np.ndarray, "points 2"]:
        """The grid points in the root frame [m], in the order of the observation."""
        x, y = np.meshgrid(self.rows, self.columns, indexing="ij")
        return np.stack([x.ravel(), y.ravel()], axis=-1)

    @property
    def size(self) -> int:
        """Number of values in an observation."""
        return MOTION_SIZE + len(self.rows) * len(self.columns) + self.counts_surfaces

    @property
    def mirror_permutation(self) -> Int[np.ndarray, " size"]:
        """Order in which an observation's values reappear when left and right are swapped."""
        heights = np.arange(len(self.rows) * len(self.columns)).reshape(len(self.rows), -1)
        mirrored = [np.arange(MOTION_SIZE), MOTION_SIZE + heights[:, ::-1].ravel()]
        return np.concatenate([*mirrored, np.arange(MOTION_SIZE + heights.size, self.size)])

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

_LAYOUTS = {layout.name: layout for layout in (THESIS144, THESIS145, ICRA81)}

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
