"""The final check of a path: the exact conditions on the polygons of its terrain."""

import logging
from dataclasses import dataclass
from pathlib import Path

import jax
import numpy as np
from jaxtyping import Bool

from jaxleas.conditions import EXACT_TWINS, STANDARD
from jaxleas.guide.places import HEADINGS, Places
from jaxleas.robots import Robot
from jaxleas.terrain import (
    PLANE_SEARCH,
    READING,
    HeightMap,
    PlaneSearch,
    Reading,
    Scene,
    cropped,
    find_surfaces,
    has_polygons,
    load_scene,
    surfaces_in_words,
)
from jaxleas.types import GuidePath, InputError, RootMotion

_LOG = logging.getLogger("jaxleas")
AROUND = 1.5
"""Distance from a path within which surfaces are sought in a map [m]."""
NEAR = 0.1 * np.arange(1, 11)
"""Distances at which an exactly valid start is sought [m]."""


@dataclass(frozen=True)
class ExactCheck:
    """The answer of the exact conditions for a path.

    Attributes:
        configurations: number of configurations of the path.
        unreachable: number of configurations that R* refuses: no leg reaches a surface under the
            root.
        colliding: number of configurations that C refuses: a polygon meets the trunk.
    """

    configurations: int
    unreachable: int
    colliding: int

    def __str__(self) -> str:
        """Return the answer as part of a sentence."""
        if not (self.unreachable or self.colliding):
            return f"the exact conditions hold at all {self.configurations} configurations"
        refused = [
            f"{name} at {count}"
            for name, count in (("R*", self.unreachable), ("C", self.colliding))
            if count
        ]
        return (
            f"the exact conditions refuse {' and '.join(refused)} of {self.configurations}"
            " configurations"
        )


def scene_of(terrain: Path, reading: Reading = READING) -> Scene | None:
    """Return the polygons of a terrain file; None for a map or an image, which has none."""
    return load_scene(terrain, reading) if has_polygons(terrain) else None


def surfaces_near(
    height_map: HeightMap, path: GuidePath, search: PlaneSearch = PLANE_SEARCH
) -> Scene | None:
    """Return the surfaces found in a map around a path; None where there is none.

    What is found, and what is left over, is said in one line.

    Args:
        height_map: height map that the path crosses.
        path: guide path of the root.
        search: what counts as a surface.
    """
    low, high = path.position[:, :2].min(axis=0), path.position[:, :2].max(axis=0)
    x, y = (tuple(each) for each in np.stack([low - AROUND, high + AROUND], axis=1).tolist())
    found = find_surfaces(cropped("the map", height_map, (*x, *y)), search)
    _LOG.warning("around the path: %s", surfaces_in_words(found))
    return Scene(found.polygons) if found.polygons else None


def refusals(
    robot: Robot, scene: Scene, path: GuidePath
) -> tuple[Bool[np.ndarray, " T"], Bool[np.ndarray, " T"]]:
    """Return which configurations of a path the exact twins of R* and of C refuse.

    Args:
        robot: robot that walks.
        scene: scene whose surfaces support contacts, and whose polygons all block.
        path: guide path of the root.
    """
    reached, free = (EXACT_TWINS[name](robot, scene, path.position, path.yaw) for name in STANDARD)
    return ~reached, ~free


def check_exactly(robot: Robot, scene: Scene, path: GuidePath) -> ExactCheck:
    """Count the configurations of a path that the exact twins of R* and C refuse.

    Args:
        robot: robot that walks.
        scene: scene whose surfaces support contacts, and whose polygons all block.
        path: guide path of the root.
    """
    unreachable, colliding = refusals(robot, scene, path)
    return ExactCheck(len(path), int(unreachable.sum()), int(colliding.sum()))


def require_exact_start(places: Places, scene: Scene, start: RootMotion) -> None:
    """Require that the exact conditions hold where a robot starts.

    Args:
        places: places of the terrain where the robot can stand.
        scene: polygons of the terrain.
        start: root motion without a batch axis, valid on the height map.

    Raises:
        InputError: a condition does not hold; the message says which, and gives the nearest pose
            on rings of 0.1 m that is valid both exactly and on the height map.
    """
    x, y, _ = (float(each) for each in start.position)
    yaw = float(start.yaw)
    unreachable, colliding = _refused_at(places, scene, np.array([[x, y]]), np.array([yaw]))
    if not (unreachable[0] or colliding[0]):
        return
    pairs = (("strict reachability R*", unreachable[0]), ("collision C", colliding[0]))
    failing = " and ".join(name for name, fails in pairs if fails)
    around = np.column_stack([np.cos(HEADINGS), np.sin(HEADINGS)])
    near = np.concatenate([[x, y] + distance * around for distance in NEAR])
    headings = np.full(len(near), yaw)
    good = places.valid(near, headings)
    good &= ~np.logical_or(*_refused_at(places, scene, near, headings))
    hint = "none is valid within 1 m"
    if good.any():
        at = near[np.argmax(good)]
        hint = f"the nearest valid pose is {at[0]:.2f},{at[1]:.2f},{yaw:.2f}"
    raise InputError(
        f"--from {x:g},{y:g} at yaw {yaw:.2f}: on the terrain's polygons {failing} fails there,"
        f" though its height map allows it; {hint}"
    )


def _refused_at(
    places: Places, scene: Scene, at: np.ndarray, yaw: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    motion = jax.tree.map(np.asarray, places.standing(at, yaw))
    still = np.zeros(len(at))
    valid = np.ones(len(at), bool)
    poses = GuidePath(still, motion.position, motion.yaw, motion.velocity, valid)
    return refusals(places.env.robot, scene, poses)
