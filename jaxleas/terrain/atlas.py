"""Many height maps as one device array, sampled by robots anywhere on any of them."""

from collections.abc import Callable, Sequence

import jax
import jax.numpy as jnp
import numpy as np
from flax import struct
from jax import Array
from jaxtyping import Float, Int, UInt32

from jaxleas.terrain.height_map import HeightMap
from jaxleas.types import NO_GROUND, InputError, is_ground
from jaxleas.xla import compute_once, hold_in_huge_pages, sine_cosine, take_inside

_ROUND = 12582912.0  # 1.5 * 2^23: adding it to a float32 leaves a whole number in the last bits
_ROUND_BITS = 0x4B400000  # the bits of _ROUND


@struct.dataclass
class Atlas:
    """Height maps of one resolution, padded with void to one shape.

    Attributes:
        heights: terrain height [m], NO_GROUND where there is no ground; the outermost cells of
            every map are NO_GROUND, so that clamping an index is the same as leaving the map.
        origin: x, y of the centre of each map's cell (0, 0) [m].
        resolution: side of a cell [m].
    """

    heights: Float[Array, "maps rows columns"]
    origin: Float[Array, "maps 2"]
    resolution: float = struct.field(pytree_node=False)

    def __len__(self) -> int:
        """Return the number of maps."""
        return self.heights.shape[0]

    def height_at(
        self, map_index: Int[Array, "*batch"], point_in_world: Float[Array, "*batch points 2"]
    ) -> Float[Array, "*batch points"]:
        """Return the terrain height [m] in the cell of each point, NO_GROUND off the map."""
        maps, rows, columns = self.heights.shape
        cells_per_metre = 1.0 / self.resolution

        def cell(axis: int, count: int) -> Array:
            offset = point_in_world[..., axis] - self.origin[map_index, axis][..., None]
            nearest = jnp.floor(offset * cells_per_metre + 0.5)
            return jnp.clip(nearest, 0, count - 1).astype(jnp.int32)

        column, row = cell(0, columns), cell(1, rows)
        index = (map_index[..., None] * rows + row) * columns + column
        # One flat gather; the index is in range by construction, so XLA need not check it.
        return take_inside(self.heights.reshape(maps * rows * columns), index)

    def heights_around(
        self,
        map_index: Int[Array, "*batch"],
        position: Float[Array, "*batch 3"],
        yaw: Float[Array, "*batch"],
        points_in_root: Float[np.ndarray, "points 2"],
        then: Callable[..., Array] = lambda heights: heights,
        *numbers: Float[Array, "*batch"],
    ) -> Float[Array, "*batch points"]:
        """Return the terrain height under points fixed to the root, relative to the root [m].

        This equals `height_at` of these points, but values per robot are computed once per robot.

        Args:
            map_index: index of each robot's map.
            position: position of the root in the world [m].
            yaw: heading of the root [rad].
            points_in_root: points in the root frame, the same for all robots [m].
            then: function applied to the heights in the same pass, so that they are not stored.
            numbers: values of each robot, as further arguments of `then`.
        """
        _, rows, columns = self.heights.shape
        cells_per_metre = 1.0 / self.resolution
        cell = (position[..., :2] - self.origin[map_index]) * cells_per_metre
        sine, cosine = (each * cells_per_metre for each in sine_cosine(yaw))
        # This subtracts the bits of `_ROUND` from the bits of a shifted row and column.
        first = map_index.astype(jnp.uint32) * jnp.uint32(rows * columns)
        first -= jnp.uint32(_ROUND_BITS * (columns + 1) % 2**32)
        ahead, left = (
            jnp.asarray(points_in_root[:, axis], jnp.float32).reshape((1,) * yaw.ndim + (-1,))
            for axis in (0, 1)
        )

        def gather(heights: Array, *robot: Array) -> Array:
            x, y, z, cosine, sine, first = (each[..., None] for each in robot[:6])
            column = _nearest(x + cosine * ahead - sine * left, columns)
            row = _nearest(y + sine * ahead + cosine * left, rows)
            index = first + row * jnp.uint32(columns) + column
            found = take_inside(heights.reshape(-1), index)
            return then(found - z, *robot[6:])

        robot = (cell[..., 0], cell[..., 1], position[..., 2], cosine, sine, first)
        return compute_once(gather, self.heights, *robot, *numbers)


def _nearest(cell: Float[Array, "*batch"], count: int) -> UInt32[Array, "*batch"]:
    """Return the nearest of the cells 0..count - 1, plus `_ROUND_BITS`.

    The result is that of clip, round and a cast, in a third of the instructions: those also handle
    NaN and values that no integer can hold.
    """
    cell = jnp.where(cell > 0.0, cell, 0.0)
    cell = jnp.where(cell < count - 1.0, cell, count - 1.0)
    return jax.lax.bitcast_convert_type(cell + _ROUND, jnp.uint32)


def make_atlas(maps: Sequence[HeightMap]) -> Atlas:
    """Stack height maps of one resolution into an atlas.

    Args:
        maps: height maps, at least one; they may differ in shape and origin.

    Raises:
        InputError: there is no map, or the resolutions differ.
    """
    if not maps:
        raise InputError("an atlas needs at least one height map")
    resolution = maps[0].resolution
    if any(abs(each.resolution - resolution) > 1e-9 for each in maps):
        given = sorted({each.resolution for each in maps})
        raise InputError(f"the maps of an atlas must share one resolution, not {given} m")
    border = 1
    rows = max(each.heights.shape[0] for each in maps) + 2 * border
    columns = max(each.heights.shape[1] for each in maps) + 2 * border
    heights = np.full((len(maps), rows, columns), NO_GROUND, dtype=np.float32)
    for padded, each in zip(heights, maps, strict=True):
        inner = padded[border : border + each.heights.shape[0], border:]
        inner[:, : each.heights.shape[1]] = np.where(
            is_ground(each.heights), each.heights, NO_GROUND
        )
    origin = np.array([each.origin for each in maps], dtype=np.float32) - border * resolution
    on_device = jnp.asarray(heights)
    hold_in_huge_pages(on_device)
    return Atlas(heights=on_device, origin=jnp.asarray(origin), resolution=resolution)
