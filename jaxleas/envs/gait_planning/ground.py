"""The fields that gaits are planned on: their heights, and where a foot may stand."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from flax import struct
from jaxtyping import Bool, Float, Float32, Int, Int32
from scipy import ndimage

from jaxleas.envs.gait_planning.config import GaitPlanningConfig, GaitWorldsConfig
from jaxleas.terrain import FIELD_KINDS, EdgeSearch, HeightMap, draw_field, find_edges
from jaxleas.types import NO_GROUND, is_ground


@struct.dataclass
class Ground:
    """Many fields of one size, one array each.

    The outermost cells of each field have no ground, so that what lies beyond has none either.

    Attributes:
        heights: heights [m]; `NO_GROUND` where there is no ground.
        safe: whether a foot may stand anywhere in the cell.
        kind: kind of each field, an index of `FIELD_KINDS`.
        resolution: side of a cell [m].
        nearest: for each cell the nearest one that is safe, counted row by row through its field;
            None where footholds are never moved.
    """

    heights: Float32[np.ndarray, "fields rows columns"]
    safe: Bool[np.ndarray, "fields rows columns"]
    kind: Int[np.ndarray, " fields"]
    resolution: float = struct.field(pytree_node=False)
    nearest: Int32[np.ndarray, "fields rows columns"] | None = None

    def heights_at(
        self, field: Int[np.ndarray, "*#batch"], points: Float[np.ndarray, "*batch 2"]
    ) -> Float32[np.ndarray, "*batch"]:
        """Return the heights of points in the fields' frames [m]."""
        return self.looked_up(self.heights, field, points)

    def safe_at(
        self, field: Int[np.ndarray, "*#batch"], points: Float[np.ndarray, "*batch 2"]
    ) -> Bool[np.ndarray, "*batch"]:
        """Return whether a foot may stand at each point."""
        return self.looked_up(self.safe, field, points)

    def looked_up(
        self,
        cells: np.ndarray,
        field: Int[np.ndarray, "*#batch"],
        points: Float[np.ndarray, "*batch 2"],
    ) -> np.ndarray:
        """Return the values of the cells that points in the fields' frames lie in.

        Args:
            cells: a value for each cell [fields, rows, columns].
            field: index of each point's field.
            points: points [m].
        """
        return cells.reshape(-1)[self._cells(field, points)]

    def snapped(
        self,
        field: Int[np.ndarray, "*#batch"],
        points: Float[np.ndarray, "*batch 2"],
        most: float,
    ) -> Float[np.ndarray, "*batch 2"]:
        """Return points on safe cells, moved to the middle of the nearest one where they are not.

        Args:
            field: index of each point's field.
            points: points [m].
            most: distance from which on a point stays where it is [m].
        """
        if self.nearest is None:
            return points
        rows, columns = self.heights.shape[1:]
        cell = self._cells(field, points) % (rows * columns)
        nearest = self.looked_up(self.nearest, field, points)
        row, column = np.divmod(nearest, columns)
        middle = self.resolution * (np.stack([column, row], axis=-1) + 0.5)
        near = np.linalg.norm(middle - points, axis=-1) < most
        return np.where((near & (nearest != cell))[..., None], middle, points)

    @property
    def size(self) -> Float[np.ndarray, "2"]:
        """Length and width of a field [m]."""
        return self.resolution * np.array(self.heights.shape[:0:-1])

    def _cells(self, field: np.ndarray, points: np.ndarray) -> Int[np.ndarray, "*batch"]:
        rows, columns = self.heights.shape[1:]
        # Clipped first: then the conversion to integers, towards zero, rounds down.
        scaled = (points * (1.0 / self.resolution)).clip(0.0, max(rows, columns)).astype(np.intp)
        row = np.minimum(scaled[..., 1], rows - 1)
        column = np.minimum(scaled[..., 0], columns - 1)
        return (field.astype(np.intp) * rows + row) * columns + column


def make_ground(
    config: GaitPlanningConfig, worlds: GaitWorldsConfig, seeds: Sequence[int]
) -> Ground:
    """Return the ground of training or of an examination: one field of each seed.

    Kinds follow each other in proportion to their shares, so that few fields have all of them.

    Args:
        config: configuration of the task, which says what a safe foothold is.
        worlds: kinds, shares and sizes of fields.
        seeds: seeds of the fields.
    """
    kinds = _kinds(worlds, len(seeds))
    fields = [
        draw_field(FIELD_KINDS[kind], worlds.field, seed)
        for kind, seed in zip(kinds, seeds, strict=True)
    ]
    return ground_of(config, fields, kinds)


def ground_of(
    config: GaitPlanningConfig, fields: Sequence[HeightMap], kinds: Int[np.ndarray, " fields"]
) -> Ground:
    """Return the ground that height maps of one shape and resolution are.

    Args:
        config: configuration of the task, which says what a safe foothold is.
        fields: height maps.
        kinds: kind of each, an index of `FIELD_KINDS`.
    """
    framed = [_framed(field) for field in fields]
    safe = [safe_cells(config, field) for field in framed]
    heights = np.stack([field.heights for field in framed])
    filled = np.where(is_ground(heights), heights, np.float32(NO_GROUND))
    nearest = np.stack([_nearest(each) for each in safe]) if config.snap else None
    return Ground(filled, np.stack(safe), kinds, fields[0].resolution, nearest)


def _nearest(safe: Bool[np.ndarray, "rows columns"]) -> Int32[np.ndarray, "rows columns"]:
    """Return the number of the safe cell nearest to each cell."""
    found: Any = ndimage.distance_transform_edt(~safe, return_distances=False, return_indices=True)
    return (found[0] * safe.shape[1] + found[1]).astype(np.int32)


def safe_cells(config: GaitPlanningConfig, field: HeightMap) -> Bool[np.ndarray, "rows columns"]:
    """Return where a foot may stand: at least `foot_clearance` from every change of height.

    An edge cell touches the change, and a point of the cell asked for lies within half a cell of
    its middle: so the distance of their middles is one to be sure of.
    """
    return edge_distance(config, field) >= config.foot_clearance


def edge_distance(
    config: GaitPlanningConfig, field: HeightMap
) -> Float[np.ndarray, "rows columns"]:
    """Return the distance of each cell from the nearest change of height [m]."""
    return find_edges(field, EdgeSearch(config.edge_rise, medians=0, closes=False)).distance


def _framed(field: HeightMap) -> HeightMap:
    heights = field.heights.copy()
    for edge in (heights[0], heights[-1], heights[:, 0], heights[:, -1]):
        edge[:] = np.nan
    return HeightMap(heights, field.resolution, field.origin)


def _kinds(worlds: GaitWorldsConfig, count: int) -> Int[np.ndarray, " count"]:
    """Return kinds such that each has about its share of every beginning of the list."""
    shares = np.array([getattr(worlds.shares, kind) for kind in FIELD_KINDS])
    wanted = np.arange(1, count + 1)[:, None] * (shares / shares.sum())
    found, given = np.empty(count, np.int64), np.zeros(len(shares))
    for index, each in enumerate(wanted):
        found[index] = np.argmax(each - given)
        given[found[index]] += 1
    return found
