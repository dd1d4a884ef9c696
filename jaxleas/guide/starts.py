"""Where a robot begins: a valid place with room around it, or a given place."""

import math

import numpy as np
from jaxtyping import Float
from scipy.ndimage import minimum_filter

from jaxleas.envs.steering import SteeringEnv
from jaxleas.guide.nearest_place import nearest_place
from jaxleas.guide.place_refusal import require_valid, why_invalid
from jaxleas.guide.places import HEADINGS, Places
from jaxleas.terrain import HeightMap
from jaxleas.types import InputError, RootMotion, RootPose

MOST_PLACES = 5_000
SPACING = 0.25  # distance between places that are tried [m]; wider on larger maps
ROOM = 5  # places along each side of a square of valid places; the robot begins in its middle


def choose_start(env: SteeringEnv, terrain: HeightMap) -> RootPose:
    """Return the valid standing pose with room around it that is farthest back (least x).

    The robot faces along x; among equals the pose nearest to the middle of the map's width is
    chosen.

    Args:
        env: steering task whose robot stands and whose condition judges.
        terrain: height map to stand on.

    Raises:
        InputError: the robot can stand nowhere on this terrain.
    """
    lattice = _lattice(terrain)
    candidates = lattice.reshape(-1, 2)
    places = Places(env, terrain)
    valid = places.valid(candidates, np.zeros(len(candidates)))
    if not valid.any():
        raise InputError(
            f"{env.robot.name} can stand nowhere on this terrain, looking along x; give --start"
        )
    around = minimum_filter(valid.reshape(lattice.shape[:2]), size=ROOM, mode="constant", cval=0)
    roomy = np.asarray(around, bool).ravel()
    chosen = candidates[roomy if roomy.any() else valid]
    x_min, _, y_min, y_max = terrain.extent
    rank = (chosen[:, 0] - x_min) + np.abs(chosen[:, 1] - 0.5 * (y_min + y_max))
    return places.pose(chosen[np.argmin(rank)], 0.0)


def require_start(
    env: SteeringEnv, terrain: HeightMap, start: tuple[float, float, float]
) -> RootPose:
    """Return the standing pose at a place, if it is valid.

    Args:
        env: steering task whose robot stands and whose condition judges.
        terrain: height map to stand on.
        start: start x, y [m] and heading [deg].

    Raises:
        InputError: the pose is not valid; the message says which condition fails, by how much, and
            where it would hold.
    """
    x, y, degrees = start
    where = f"--start {x:g} {y:g} {degrees:g}"
    if not np.isfinite(start).all():
        raise InputError(f"{where}: give finite numbers, x y [m], yaw [deg]")
    place, yaw = np.array([x, y]), float(np.radians(degrees))
    places = Places(env, terrain)
    if places.valid(place[None], np.array([yaw]))[0]:
        return places.pose(place, yaw)
    problem = why_invalid(places, place, np.array([yaw]), f"at {degrees:g} deg")
    nearest = nearest_place(places, place, yaw)
    if nearest is None:
        raise InputError(f"{where}: {problem}; nowhere on this terrain can the robot stand")
    (x, y), heading = nearest
    raise InputError(
        f"{where}: {problem}; the nearest valid place is {x:.2f} {y:.2f} {np.degrees(heading):.4g}"
    )


def start_motion(
    places: Places, start: tuple[float, float], goal: tuple[float, float], yaw: float | None
) -> RootMotion:
    """Return the root motion of a robot at rest at the start.

    Args:
        places: places of the terrain where the robot can stand.
        start: start x, y [m].
        goal: goal x, y [m].
        yaw: heading [rad]; None takes the valid heading nearest to the direction of the goal.

    Raises:
        InputError: the robot cannot stand there.
    """
    if yaw is None:
        facing = math.atan2(goal[1] - start[1], goal[0] - start[0])
        headings = facing + np.array(sorted(HEADINGS, key=abs))
        valid = places.valid(np.tile(start, (len(headings), 1)), headings)
        yaw = float(headings[np.argmax(valid)]) if valid.any() else None
    pose = require_valid(places, "--from", start, yaw)
    heading = float(pose.yaw) if yaw is None else yaw
    motion = places.standing(np.array([start]), np.array([heading]))
    return RootMotion(motion.position[0], motion.velocity[0], motion.yaw[0])


def _lattice(terrain: HeightMap) -> Float[np.ndarray, "R C 2"]:
    x_min, x_max, y_min, y_max = terrain.extent
    spacing = max(SPACING, np.sqrt((x_max - x_min) * (y_max - y_min) / MOST_PLACES))
    x = np.arange(x_min + 0.5 * spacing, x_max, spacing)
    y = np.arange(y_min + 0.5 * spacing, y_max, spacing)
    return np.stack(np.meshgrid(x, y), axis=-1)
