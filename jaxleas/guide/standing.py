"""Where a robot can stand: a place to begin, and the nearest one to a place where it cannot."""

from functools import partial
from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Bool, Float
from scipy.ndimage import minimum_filter

from jaxleas.conditions import collision, strict_reachability
from jaxleas.envs.steering.env import SteeringEnv
from jaxleas.terrain.atlas import Atlas, make_atlas
from jaxleas.terrain.height_map import HeightMap
from jaxleas.types import InputError, RootMotion, is_ground

MOST_PLACES = 5_000
SPACING = 0.25  # between places that are tried [m]; wider on maps that are larger
ROOM = 5  # places along each side of the square of valid ones in whose middle to begin


class Pose(NamedTuple):
    """Where an upright root is.

    Attributes:
        position: in the world [m].
        yaw: heading [rad].
    """

    position: Float[np.ndarray, " 3"]
    yaw: float


def choose_start(env: SteeringEnv, terrain: HeightMap) -> Pose:
    """Return a valid standing pose with room around it, as far back (least x) as there is one.

    It looks along x, and among equals stands in the middle of the map's width.

    Args:
        env: whose robot stands, and whose condition judges.
        terrain: to stand on.

    Raises:
        InputError: the robot can stand nowhere on this terrain.
    """
    lattice = _lattice(terrain)
    places = lattice.reshape(-1, 2)
    valid = _valid(env, terrain, places, 0.0)
    if not valid.any():
        raise InputError(
            f"{env.robot.name} can stand nowhere on this terrain, looking along x; give --start"
        )
    around = minimum_filter(valid.reshape(lattice.shape[:2]), size=ROOM, mode="constant", cval=0)
    roomy = np.asarray(around, bool).ravel()
    chosen = places[roomy if roomy.any() else valid]
    x_min, _, y_min, y_max = terrain.extent
    rank = (chosen[:, 0] - x_min) + np.abs(chosen[:, 1] - 0.5 * (y_min + y_max))
    return _stand(env, terrain, chosen[np.argmin(rank)], 0.0)


def require_start(env: SteeringEnv, terrain: HeightMap, start: tuple[float, float, float]) -> Pose:
    """Return the standing pose at a place, if it is valid.

    Args:
        env: whose robot stands, and whose condition judges.
        terrain: to stand on.
        start: x, y [m] and heading [deg].

    Raises:
        InputError: it is not: says which condition fails, by how much, and where it would hold.
    """
    x, y, degrees = start
    if not np.isfinite(start).all():
        raise InputError(
            f"--start {x:g} {y:g} {degrees:g}: give finite numbers, x y [m], yaw [deg]"
        )
    place, yaw = np.array([x, y]), float(np.radians(degrees))
    if _valid(env, terrain, place[None], yaw)[0]:
        return _stand(env, terrain, place, yaw)
    where = f"--start {x:g} {y:g} {degrees:g}"
    ground = terrain.height_at(place[None])[0]
    if not is_ground(ground):
        problem = "there is no ground there"
    else:
        motion = _standing(env, terrain, place[None], yaw)
        heights = _heights(env, make_atlas([terrain]), motion)
        conditions = {
            "the legs reach no ground under the root (R*)": strict_reachability,
            "the trunk meets the ground (C)": collision,
        }
        worst = {
            text: float(make(env.robot, env.points_in_root)(heights, motion)[0])
            for text, make in conditions.items()
        }
        text = min(worst, key=lambda each: worst[each])
        problem = f"{text}, by {-worst[text]:.2f} m"
    places = _lattice(terrain).reshape(-1, 2)
    valid = places[_valid(env, terrain, places, yaw)]
    if not len(valid):
        raise InputError(f"{where}: {problem}; with this heading there is no valid place anywhere")
    nearest = valid[np.argmin(np.sum((valid - place) ** 2, axis=1))]
    raise InputError(
        f"{where}: {problem}; the nearest valid place is {nearest[0]:.2f} {nearest[1]:.2f}"
    )


def _lattice(terrain: HeightMap) -> Float[np.ndarray, "R C 2"]:
    x_min, x_max, y_min, y_max = terrain.extent
    spacing = max(SPACING, np.sqrt((x_max - x_min) * (y_max - y_min) / MOST_PLACES))
    x = np.arange(x_min + 0.5 * spacing, x_max, spacing)
    y = np.arange(y_min + 0.5 * spacing, y_max, spacing)
    return np.stack(np.meshgrid(x, y), axis=-1)


def _stand(env: SteeringEnv, terrain: HeightMap, place: np.ndarray, yaw: float) -> Pose:
    ground = float(terrain.height_at(place[None])[0])
    return Pose(np.array([place[0], place[1], ground + env.robot.walking_height]), yaw)


def _valid(
    env: SteeringEnv, terrain: HeightMap, places: np.ndarray, yaw: float
) -> Bool[np.ndarray, " N"]:
    margin = _margin(env, make_atlas([terrain]), _standing(env, terrain, places, yaw))
    # A root measured from the void would see the void at walking height and pass for valid.
    return (np.asarray(margin) >= 0.0) & is_ground(terrain.height_at(places))


@partial(jax.jit, static_argnames="env")
def _margin(env: SteeringEnv, atlas: Atlas, motion: RootMotion) -> jax.Array:
    return env.condition(_heights(env, atlas, motion), motion)


def _heights(env: SteeringEnv, atlas: Atlas, motion: RootMotion) -> jax.Array:
    return env.local_heights(atlas, jnp.zeros(motion.yaw.shape, jnp.int32), motion)


def _standing(env: SteeringEnv, terrain: HeightMap, places: np.ndarray, yaw: float) -> RootMotion:
    ground = np.nan_to_num(terrain.height_at(places)) + env.robot.walking_height
    return RootMotion(
        position=jnp.asarray(np.column_stack([places, ground]), jnp.float32),
        velocity=jnp.zeros((len(places), 3), jnp.float32),
        yaw=jnp.full(len(places), yaw, jnp.float32),
    )
