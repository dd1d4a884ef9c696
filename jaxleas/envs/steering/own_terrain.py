"""Places where a robot can stand on the user's own terrain, and goals within walking distance.

Such terrain does not state its crossings, so it is searched once on the host: places where R* and C
hold, and for each some others within walking distance. Starts and goals come from these tables.
"""

from collections.abc import Sequence

import jax
import jax.numpy as jnp
import numpy as np
from flax import struct
from jax import Array
from jaxtyping import Bool, Float, Int, Key
from scipy.spatial import KDTree

from jaxleas.conditions import Collision, StrictReachability, all_of, footprint_points
from jaxleas.robots import Robot
from jaxleas.terrain import HeightMap, make_atlas
from jaxleas.types import InputError, RootMotion, is_ground

NEAREST, FARTHEST = 1.5, 6.0
"""Distance from a start to its goal, and from goal to goal [m]."""
MOST_PLACES = 16_384  # per file
GOALS_A_PLACE = 16
SPREAD = 0.2  # starts lie around their place in a square of this half side [m]
_HEADINGS = np.linspace(-np.pi, np.pi, 8, endpoint=False)
_AT_ONCE = 4096  # places judged in one compiled call
_ROUNDS = 32  # attempts at drawing goals


@struct.dataclass
class OwnTerrain:
    """Places to stand at on the maps of terrain files; a pytree.

    Attributes:
        share: share of the starts that fall on files, divided evenly among them.
        map_index: map of each file in the atlas.
        first: index of each file's first place.
        count: number of each file's places.
        place: place to stand at, x and y [m].
        goals: indices of places within walking distance of each place.
    """

    share: Float[Array, ""]
    map_index: Int[Array, " files"]
    first: Int[Array, " files"]
    count: Int[Array, " files"]
    place: Float[Array, "places 2"]
    goals: Int[Array, "places choices"]


@struct.dataclass
class OwnStarts:
    """Starts and goals on files, drawn for every candidate.

    Attributes:
        chosen: whether the candidate starts on a file.
        map_index: index of the map in the atlas.
        start: position of the start [m].
        goals: positions of the goals, one after another [m].
    """

    chosen: Bool[Array, " candidates"]
    map_index: Int[Array, " candidates"]
    start: Float[Array, "candidates 2"]
    goals: Float[Array, "candidates goals 2"]


def make_own_terrain(
    robot: Robot, maps: Sequence[tuple[str, HeightMap]], share: float, first_map: int
) -> OwnTerrain:
    """Search height maps for places to stand at.

    Args:
        robot: robot that has to stand there.
        maps: name and height map of each file.
        share: share of the starts that fall on files.
        first_map: index of the first of the maps in the atlas.

    Raises:
        InputError: a map has no room for a start and a goal.
    """
    places, goals, counts = [], [], []
    for number, (name, height_map) in enumerate(maps):
        chance = np.random.default_rng(number)  # the same tables whenever a run is resumed
        standing = _standing_places(robot, height_map, chance)
        near = _goals_of(standing, chance)
        kept = near[:, 0] >= 0
        if not kept.any():
            raise InputError(
                f"{name}: {robot.name} finds no two places to stand at that are {NEAREST:g} to"
                f" {FARTHEST:g} m apart; terrain to train on needs that much ground"
            )
        renumbered = np.cumsum(kept) - 1 + sum(counts)
        places.append(standing[kept])
        goals.append(renumbered[near[kept]])
        counts.append(int(kept.sum()))
    return OwnTerrain(
        share=jnp.float32(share),
        map_index=jnp.arange(first_map, first_map + len(maps), dtype=jnp.int32),
        first=jnp.asarray(np.cumsum([0, *counts[:-1]]), jnp.int32),
        count=jnp.asarray(counts, jnp.int32),
        place=jnp.asarray(np.concatenate(places), jnp.float32),
        goals=jnp.asarray(np.concatenate(goals), jnp.int32),
    )


def draw_own_starts(own: OwnTerrain, key: Key[Array, ""], count: int, goals: int) -> OwnStarts:
    """Draw candidates for starts on files: a file, a place on it, and goals not far from it.

    Args:
        own: places to stand at.
        key: random key, consumed here.
        count: number of candidates.
        goals: number of goals per candidate.
    """
    share_key, file_key, place_key, spread_key, goal_key = jax.random.split(key, 5)
    chosen = jax.random.uniform(share_key, (count,)) < own.share
    file = jax.random.randint(file_key, (count,), 0, len(own.map_index))
    within = jax.random.uniform(place_key, (count,)) * own.count[file]
    place = own.first[file] + jnp.minimum(within.astype(jnp.int32), own.count[file] - 1)
    spread = jax.random.uniform(spread_key, (count, 2), minval=-SPREAD, maxval=SPREAD)
    choice = jax.random.randint(goal_key, (goals, count), 0, own.goals.shape[1])
    sought, here = [], place
    for number in range(goals):
        here = own.goals[here, choice[number]]
        sought.append(own.place[here])
    return OwnStarts(
        chosen=chosen,
        map_index=own.map_index[file],
        start=own.place[place] + spread,
        goals=jnp.stack(sought, axis=1),
    )


def _standing_places(
    robot: Robot, height_map: HeightMap, chance: np.random.Generator
) -> Float[np.ndarray, "N 2"]:
    """Return places, drawn at random from all ground, where R* and C hold for some heading."""
    ground = np.flatnonzero(is_ground(height_map.heights))
    tried = chance.choice(ground, min(len(ground), 4 * MOST_PLACES), replace=False)
    rows, columns = np.divmod(tried, height_map.shape[1])
    inside = chance.uniform(-0.5, 0.5, (len(tried), 2))
    cells = (np.stack([columns, rows], axis=1) + inside) * height_map.resolution
    places = np.asarray(height_map.origin) + cells
    atlas, points = make_atlas([height_map]), footprint_points(robot)
    condition = all_of(StrictReachability(robot, points), Collision(robot, points), order=points)

    @jax.jit
    def margin(position: Array, yaw: Array) -> Array:
        motion = RootMotion(position, jnp.zeros_like(position), yaw)
        index = jnp.zeros(yaw.shape, jnp.int32)
        heights = atlas.heights_around(index, position, yaw, condition.points_in_root)
        return condition(heights, motion)

    found: list[np.ndarray] = []
    for begin in range(0, len(places), _AT_ONCE):
        if sum(map(len, found)) >= MOST_PLACES:
            break
        some = places[begin : begin + _AT_ONCE]
        padded = np.resize(some, (_AT_ONCE, 2))  # one compiled shape
        z = height_map.height_at(padded) + robot.walking_height
        position = jnp.asarray(np.column_stack([padded, z]), jnp.float32)
        margins = [margin(position, jnp.full(_AT_ONCE, yaw, jnp.float32)) for yaw in _HEADINGS]
        best = np.max(np.stack(margins), axis=0)
        found.append(some[best[: len(some)] >= 0.0])
    return np.concatenate([*found, np.zeros((0, 2))])[:MOST_PLACES]


def _goals_of(
    places: Float[np.ndarray, "N 2"], chance: np.random.Generator
) -> Int[np.ndarray, "N choices"]:
    """Return, for each place, others within walking distance in any direction; -1 for no place."""
    # Starts lie around their place: the distances hold from everywhere in that square.
    corner = SPREAD * np.sqrt(2.0) + 1e-3
    nearest, farthest = NEAREST + corner, FARTHEST - corner
    goals = np.full((len(places), GOALS_A_PLACE), -1, np.int64)
    if len(places) < 2:
        return goals
    tree, have = KDTree(places), np.zeros(len(places), np.int64)
    for _ in range(_ROUNDS):
        angle = chance.uniform(-np.pi, np.pi, len(places))
        wanted = chance.uniform(nearest, farthest, len(places))[:, None]
        there = places + wanted * np.stack([np.cos(angle), np.sin(angle)], axis=1)
        other = np.asarray(tree.query(there)[1])
        distance = np.linalg.norm(places[other] - places, axis=1)
        rows = np.flatnonzero(
            (distance >= nearest) & (distance <= farthest) & (have < GOALS_A_PLACE)
        )
        goals[rows, have[rows]] = other[rows]
        have[rows] += 1
    for row in np.flatnonzero(have == 0):  # none was drawn at random: search all
        distance = np.linalg.norm(places - places[row], axis=1)
        others = np.flatnonzero((distance >= nearest) & (distance <= farthest))[:GOALS_A_PLACE]
        goals[row, : len(others)], have[row] = others, len(others)
    # Places with few goals list them several times.
    again = np.arange(GOALS_A_PLACE) % np.maximum(have, 1)[:, None]
    return np.take_along_axis(goals, again, axis=1)
