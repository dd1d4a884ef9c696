"""Where the robots of a cell begin: valid, upright, at the cell's heading and speed."""

import zlib
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array
from jaxtyping import Float, Int

from jaxleas.envs.steering import SteeringEnv, standing_position
from jaxleas.evaluation.suites import Cell
from jaxleas.geometry import wrap_angle_on_host
from jaxleas.terrain import (
    Atlas,
    CellCount,
    HeightMap,
    NoiseConfig,
    Scenario,
    SensedAtlas,
    make_atlas,
    rasterise,
    sense,
)
from jaxleas.types import NO_GROUND_IN_ROOT, InputError, RootMotion, is_ground

RESOLUTION = 0.04
"""Resolution of the height maps used for judging [m]: the same as in training."""
ROUNDS = 200
"""Number of draws after which a start area without a valid start is given up."""


@dataclass(frozen=True)
class Grounds:
    """The scenes of a suite as height maps.

    Attributes:
        maps: one height map per scene.
        atlas: those maps on the device; one shape for all cells, so that roll-outs compile once.
        index: index of each scene's map, by the scene's identity.
        sensed: those maps as robots see them; None: robots see the terrain itself.
        count: what became of their cells, where robots see them through sensors.
    """

    maps: list[HeightMap]
    atlas: Atlas
    index: dict[int, int]
    sensed: SensedAtlas | None = None
    count: CellCount | None = None

    def seen_through(self, noise: NoiseConfig, seed: int) -> "Grounds":
        """Return the same scenes, which robots see with noise drawn from a seed."""
        sensed, count = sense(self.atlas, noise, jax.random.key(seed))
        return replace(self, sensed=sensed, count=count)


def make_grounds(cells: Sequence[Cell], resolution: float = RESOLUTION) -> Grounds:
    """Rasterise every scene of these cells once."""
    scenarios = {id(each): each for cell in cells for each in cell.scenarios}
    maps = [rasterise(each.scene, resolution) for each in scenarios.values()]
    index = {identity: position for position, identity in enumerate(scenarios)}
    return Grounds(maps, make_atlas(maps), index)


@dataclass(frozen=True)
class Starts:
    """The starts of a cell.

    Attributes:
        motion: motions of the roots.
        map_index: map of each start's scene.
        waypoints: waypoints in order, the goal last: x, y and the root height there [m].
        area: start area of its scene that each start lies in (0 near, 1 far).
        scene: index of the cell's scenario that each start lies in.
    """

    motion: RootMotion
    map_index: Int[Array, " N"]
    waypoints: Float[Array, "N W 3"]
    area: Int[np.ndarray, " N"]
    scene: Int[np.ndarray, " N"]


def draw_starts(env: SteeringEnv, grounds: Grounds, cell: Cell, seed: int) -> Starts:
    """Draw the starts of a cell: uniform in the start areas, upright at walking height.

    A start that already violates the condition is drawn again: otherwise it would be judged
    before it could move.

    Args:
        env: environment that decides what is valid, and how high the robot walks.
        grounds: height maps of the suite.
        cell: cell of the suite.
        seed: seed of the suite; every cell has a random stream of its own.

    Raises:
        InputError: a start area holds no valid start.
    """
    key = [seed, zlib.crc32(cell.name.encode()), round(cell.yaw * 1000) % 360_000]
    rng = np.random.default_rng(key)
    goals = _waypoints(env, grounds, cell, rng)
    areas_each = len(cell.scenarios[0].start_areas)
    number = np.arange(cell.starts)
    area, scene = number % areas_each, number // areas_each % len(cell.scenarios)
    chosen = [cell.scenarios[index] for index in scene]
    rectangle = np.array([each.start_areas[k] for each, k in zip(chosen, area, strict=True)])
    aside = _headings_aside(cell, rng)
    map_index = jnp.asarray([grounds.index[id(each)] for each in chosen], dtype=jnp.int32)

    low, high = rectangle[:, 0::2], rectangle[:, 1::2]
    horizontal, valid = np.array(low), np.zeros(cell.starts, dtype=bool)
    motion = None
    for _ in range(ROUNDS):
        drawn = rng.uniform(low, high)
        horizontal = np.where(valid[:, None], horizontal, drawn)
        ahead = _way_ahead(cell, scene, goals[scene, 0, :2] - horizontal)
        motion, judged = _standing(
            env,
            grounds.atlas,
            map_index,
            jnp.asarray(horizontal, dtype=jnp.float32),
            jnp.asarray(wrap_angle_on_host(ahead + aside), dtype=jnp.float32),
            jnp.float32(cell.speed),
        )
        valid = np.asarray(judged)
        if valid.all():
            break
    if motion is None or not valid.all():
        where = [round(float(each), 2) for each in rectangle[np.argmin(valid)]]
        raise InputError(
            f"no valid start in the area {where} of scene {cell.name!r} after {ROUNDS} draws"
        )
    return Starts(motion, map_index, jnp.asarray(goals[scene], dtype=jnp.float32), area, scene)


def require_known_ground(env: SteeringEnv, grounds: Grounds, cell: Cell, starts: Starts) -> None:
    """Refuse maps of sensors on which no height is known around any start of a cell.

    Around a few starts that may be so by chance: there the robot stands still.

    Raises:
        InputError: no start has a known height among the points that the robot reads.
    """
    if grounds.sensed is None:
        return
    sensed, motion = grounds.sensed, starts.motion
    heights = env.local_heights(sensed, starts.map_index, motion)
    if not bool(jnp.any(heights > NO_GROUND_IN_ROOT)):
        raise InputError(
            f"the noise leaves no height known around any start of {cell.name!r}: lower missing or"
            " holes, or raise fill"
        )


def _way_ahead(
    cell: Cell, scene: Int[np.ndarray, " N"], to_goal: Float[np.ndarray, "N 2"]
) -> Float[np.ndarray, " N"]:
    """Return the direction that each start's heading is relative to [rad]."""
    if cell.aim == "goal":
        return np.arctan2(to_goal[:, 1], to_goal[:, 0])
    return np.array([crossing_direction(each) for each in cell.scenarios])[scene]


def _headings_aside(cell: Cell, rng: np.random.Generator) -> Float[np.ndarray, " N"]:
    """Return how far each start's heading is off the way ahead [rad]."""
    degrees = np.full(cell.starts, cell.yaw)
    if cell.yaw_spread > 0.0:
        degrees += rng.uniform(-cell.yaw_spread, cell.yaw_spread, size=cell.starts)
        degrees *= rng.choice([-1.0, 1.0], size=cell.starts)
    return np.deg2rad(degrees)


def crossing_direction(scenario: Scenario) -> float:
    """Return the heading [rad] from the start areas to where the robot is sent first."""
    areas = np.array(scenario.start_areas).reshape(-1, 2, 2)
    start = areas.mean(axis=(0, 2))
    goal = np.array(scenario.waypoints[0]) if scenario.waypoints else _centre(scenario.goal_area)
    return float(np.arctan2(goal[1] - start[1], goal[0] - start[0]))


def _centre(area: Sequence[float]) -> Float[np.ndarray, " 2"]:
    return np.array(area, dtype=np.float64).reshape(2, 2).mean(axis=1)


def _waypoints(
    env: SteeringEnv, grounds: Grounds, cell: Cell, rng: np.random.Generator
) -> Float[np.ndarray, "scenes W 3"]:
    """Return one goal per scene, drawn in its goal area, or the scene's own waypoints."""
    points = []
    for scenario in cell.scenarios:
        area = np.array(scenario.goal_area)
        drawn = [rng.uniform(area[0::2], area[1::2])]
        horizontal = np.array(scenario.waypoints or drawn, dtype=np.float64)
        height_map = grounds.maps[grounds.index[id(scenario)]]
        ground = height_map.height_at(horizontal).astype(np.float64)
        # A goal in the void has no height: use that of the start.
        start = height_map.height_at(_centre(scenario.start_areas[0])[None])
        ground = np.where(is_ground(ground), ground, start)
        points.append(np.column_stack([horizontal, ground + env.robot.walking_height]))
    longest = max(len(each) for each in points)
    # Scenes with fewer waypoints repeat their last: it is reached as soon as it is targeted.
    return np.stack([np.vstack([each, *[each[-1:]] * (longest - len(each))]) for each in points])


@partial(jax.jit, static_argnums=0)
def _standing(
    env: SteeringEnv,
    atlas: Atlas,
    map_index: Int[Array, " N"],
    horizontal: Float[Array, "N 2"],
    yaw: Float[Array, " N"],
    speed: Float[Array, ""],
) -> tuple[RootMotion, Array]:
    """Return roots at walking height above the ground, and whether they are valid there."""
    ground = atlas.height_at(map_index, horizontal[:, None, :])[:, 0]
    position = standing_position(env.robot, atlas, map_index, horizontal)
    ahead = jnp.stack([jnp.cos(yaw), jnp.sin(yaw), jnp.zeros_like(yaw)], axis=-1)
    motion = RootMotion(position=position, velocity=speed * ahead, yaw=yaw)
    margin = env.condition(env.local_heights(atlas, map_index, motion), motion)
    return motion, (margin >= 0.0) & is_ground(ground)
