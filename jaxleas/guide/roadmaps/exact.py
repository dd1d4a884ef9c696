"""The last word on a path: the exact conditions, on the polygons of its terrain."""

from dataclasses import dataclass
from pathlib import Path

from jaxleas.conditions import exact_collision, exact_strict_reachability
from jaxleas.robots import Robot
from jaxleas.terrain.mesh_scene import mesh_to_scene
from jaxleas.terrain.meshes import SUFFIXES, Up
from jaxleas.terrain.scene import Scene, read_scene
from jaxleas.types import GuidePath


@dataclass(frozen=True)
class ExactVerdict:
    """What the exact conditions say of a path.

    Attributes:
        configurations: of the path.
        unreachable: of these, refused by R*: no leg reaches a surface under the root.
        colliding: refused by C: a polygon meets the trunk.
    """

    configurations: int
    unreachable: int
    colliding: int

    def __str__(self) -> str:
        """Return the verdict as part of a sentence."""
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


def scene_of(terrain: Path, up: Up = "z", scale: float = 1.0) -> Scene | None:
    """Return the polygons of a terrain file; None for a map or an image, which has none."""
    if terrain.suffix.lower() == ".json":
        return read_scene(terrain)
    if terrain.suffix.lower() in SUFFIXES:
        return mesh_to_scene(terrain, up, scale)
    return None


def judge_exactly(robot: Robot, scene: Scene, path: GuidePath) -> ExactVerdict:
    """Judge every configuration of a path by the exact twins of R* and C.

    Args:
        robot: that walks.
        scene: whose surfaces carry, and whose polygons all block.
        path: of the root.
    """
    reached = exact_strict_reachability(robot, scene.surfaces.values(), path.position, path.yaw)
    free = exact_collision(robot, scene.polygons, path.position, path.yaw)
    return ExactVerdict(len(path), int((~reached).sum()), int((~free).sum()))
