"""The world of the robots: an atlas of terrains and the links to cross on them."""

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import jax.numpy as jnp
import numpy as np
from flax import struct
from jax import Array
from jaxtyping import Bool, Float, Int, Key

from jaxleas.envs.steering.own_terrain import OwnTerrain, make_own_terrain
from jaxleas.envs.steering.terrain_config import LinkShares
from jaxleas.robots import Robot
from jaxleas.terrain import (
    Arena,
    Atlas,
    HeightMap,
    Link,
    NoiseConfig,
    SensedAtlas,
    Terrains,
    make_atlas,
    rasterise,
    sense,
)
from jaxleas.types import InputError

DEAD_ENDS = ("cliff", "void")  # kinds of links whose goal cannot be reached
KINDS = tuple(LinkShares.model_fields)
"""Kinds of links: the groups of an episode's starts."""
MOST_CELLS = 2**29  # in an atlas, including padding: two gibibytes
NEAR = 0.8  # depth of the strip that counts as near to the crossing [m]


@struct.dataclass
class World:
    """Terrains and tasks; a pytree, so that it can live on the device and be swept.

    Attributes:
        atlas: height maps.
        map_index: index of each link's arena in the atlas.
        start_area: bounds x_min, x_max, y_min, y_max of the area where a link's crossing starts
            [m].
        near_area: bounds of the strip of that area next to the crossing [m].
        goal_area: bounds of the area where a link's crossing ends [m].
        arena_area: bounds of each link's whole arena, for random goals [m].
        kind: number of each link's kind, an index of `KINDS`.
        crossable: whether the goal can be reached; at a dead end it cannot.
        cumulative_share: share of the starts that fall on each link and those before it; it ends
            at 1.
        own: places to start from on terrain files; None: there are no such files.
        sensed: maps as the robots see them; None: they see the terrain itself.
    """

    atlas: Atlas
    map_index: Int[Array, " links"]
    start_area: Float[Array, "links 4"]
    near_area: Float[Array, "links 4"]
    goal_area: Float[Array, "links 4"]
    arena_area: Float[Array, "links 4"]
    kind: Int[Array, " links"]
    crossable: Bool[Array, " links"]
    cumulative_share: Float[Array, " links"]
    own: OwnTerrain | None = None
    sensed: SensedAtlas | None = None

    @property
    def seen(self) -> Terrains:
        """What the robots see of the terrain."""
        return self.atlas if self.sensed is None else self.sensed


@dataclass(frozen=True)
class OwnMaps:
    """Terrain files to train on besides the arenas.

    Attributes:
        maps: name and height map of each file.
        share: share of the starts that fall on the files.
        robot: robot for which there must be room to stand.
    """

    maps: Sequence[tuple[str, HeightMap]]
    share: float
    robot: Robot


def make_world(
    arenas: Sequence[Arena],
    resolution: float,
    shares: Mapping[str, float] | None = None,
    files: OwnMaps | None = None,
) -> World:
    """Rasterise arenas into one atlas and list their links.

    Args:
        arenas: arenas with at least one link among them.
        resolution: side of a height map's cell [m].
        shares: relative share of starts by kind of link, split evenly among the links of a kind;
            None: every link is equally likely, and dead ends are left out.
        files: terrain files to train on as well; None: no files.

    Raises:
        InputError: no arena has a link, or no link is of a kind with a share; a file has no room
            to stand; or all maps together are too large.
    """
    maps = [rasterise(arena.scene, resolution) for arena in arenas]
    links = [
        (index, link)
        for index, arena in enumerate(arenas)
        for link in (*arena.links, *(arena.dead_ends if shares else ()))
    ]
    if not links:
        raise InputError(
            "the generated arenas hold no link to cross: give more rows or columns of tiles"
        )
    extents = [each.extent for each in maps]
    own = None
    if files is not None:
        # Near the origin, because float32 is coarse at the coordinates of a survey.
        near = [(name, replace(each, origin=(0.0, 0.0))) for name, each in files.maps]
        _require_room(maps, near)
        own = make_own_terrain(files.robot, near, files.share, first_map=len(maps))
        maps = [*maps, *(each for _, each in near)]
    return World(
        atlas=make_atlas(maps),
        map_index=jnp.asarray([index for index, _ in links], dtype=jnp.int32),
        start_area=_areas([link.start_area for _, link in links]),
        near_area=_areas([_near(link) for _, link in links]),
        goal_area=_areas([link.goal_area for _, link in links]),
        arena_area=_areas([extents[index] for index, _ in links]),
        kind=jnp.asarray([KINDS.index(link.kind) for _, link in links], dtype=jnp.int32),
        crossable=jnp.asarray([link.kind not in DEAD_ENDS for _, link in links]),
        cumulative_share=_cumulative([link.kind for _, link in links], shares),
        own=own,
    )


def as_sensed(world: World, noise: NoiseConfig, key: Key[Array, ""]) -> World:
    """Return a world whose terrain robots see through sensors; it is the same otherwise.

    Args:
        world: terrains and tasks.
        noise: what is wrong with the maps that robots see.
        key: random key, consumed here.

    Raises:
        InputError: no height of any map is known.
    """
    sensed, count = sense(world.atlas, noise, key)
    if float(count.unknown) >= 1.0:
        raise InputError(
            "terrain.noise leaves no height known around any start: lower missing or holes, or"
            " raise fill"
        )
    return world.replace(sensed=sensed)  # type: ignore[attr-defined]


def _require_room(arenas: Sequence[HeightMap], files: Sequence[tuple[str, HeightMap]]) -> None:
    """Refuse files that would make the atlas, where all maps are padded to one shape, too large."""
    name, largest = max(files, key=lambda each: each[1].heights.size)
    maps = [*arenas, *(each for _, each in files)]
    rows, columns = (max(each.shape[axis] for each in maps) for axis in (0, 1))
    if (cells := len(maps) * rows * columns) > MOST_CELLS:
        raise InputError(
            f"{name} has {largest.shape[0]} x {largest.shape[1]} cells: {len(maps)} maps padded to"
            f" {rows} x {columns} would take {4 * cells / 2**30:.1f} GiB, more than the"
            f" {4 * MOST_CELLS / 2**30:g} accepted; give a part of it, larger cells"
            " (terrain.resolution), or fewer terrain.arenas"
        )


def _near(link: Link) -> tuple[float, ...]:
    """Return the strip of a start area right before the crossing."""
    area = np.array(link.start_area)
    for axis, direction in enumerate(link.direction):
        low, high = 2 * axis, 2 * axis + 1
        if direction > 0:
            area[low] = max(area[low], area[high] - NEAR)
        elif direction < 0:
            area[high] = min(area[high], area[low] + NEAR)
    return tuple(area)


def _cumulative(kinds: Sequence[str], shares: Mapping[str, float] | None) -> Array:
    count = Counter(kinds)
    weight = np.array([shares[kind] / count[kind] if shares else 1.0 for kind in kinds])
    if weight.sum() <= 0.0:
        raise InputError(
            f"the links are of the kinds {', '.join(sorted(count))}, none of which has a share of"
            " the starts: raise one in terrain.shares"
        )
    cumulative = np.cumsum(weight) / weight.sum()
    cumulative[-1] = 1.0
    return jnp.asarray(cumulative, dtype=jnp.float32)


def _areas(areas: Sequence[Sequence[float]]) -> Array:
    return jnp.asarray(np.array(areas, dtype=np.float32).reshape(-1, 4))
