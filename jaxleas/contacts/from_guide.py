"""From a guide path and a scene to a contact problem: motion before contact (T 5.2.2, 5.2.3)."""

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np
from jaxtyping import Float

from jaxleas.contacts.models import default_model
from jaxleas.contacts.polytopes import StepPolytopes, load_step_polytopes
from jaxleas.contacts.problem import ContactProblem, FootPose, Model, Step
from jaxleas.contacts.programs.constraints import rotation
from jaxleas.contacts.reference import reference_foothold
from jaxleas.contacts.surfaces import ContactSurface, make_surface
from jaxleas.geometry import (
    Box,
    Polytope,
    clip_polygon,
    pack_polygons,
    polygons_meet_polytope,
    wrap_angle_on_host,
)
from jaxleas.robots import Robot, load_robot
from jaxleas.terrain import Scene, polygon_area_vector
from jaxleas.types import GuidePath, InputError

Candidates = Literal["window", "rom"]
EVERY = 14
"""Every N-th configuration is kept, N_ref of T 5.2.3: 28 cm at 2 cm per configuration."""
WINDOW = 0.8
"""Edge of the square around the root in which a foot may land (T 5.2.3) [m]."""
LEAST_PART = 1e-4
"""A part of a surface with a smaller area than this is no candidate [m^2]."""
MOST_ASIDE = 0.2
"""A foot that finds no ground within this distance [m] of its reference place cannot stand."""


@dataclass(frozen=True)
class Stepping:
    """How a guide path becomes steps.

    Attributes:
        model: "two_com" or "feet"; by default "two_com" for two feet with polytopes of the centre
            of mass, and "feet" for any others.
        every: number N: every N-th configuration is kept.
        candidates: "window": parts of surfaces in a square around the root, turned with it; "rom":
            parts of surfaces in the range of motion of the leg that moves.
        window: length of the edges of the square [m].
        first_foot: name of the foot that moves first; the robot's first foot by default.

    Raises:
        InputError: a number is out of range.
    """

    model: Model | None = None
    every: int = EVERY
    candidates: Candidates = "window"
    window: float = WINDOW
    first_foot: str | None = None

    def __post_init__(self) -> None:
        if self.every < 1:
            raise InputError(
                f"every {self.every} must be at least 1: every N-th configuration is kept"
            )
        if not 0.0 < self.window < 100.0:
            raise InputError(f"window {self.window} must be an edge in metres, 0.8 is usual")


class NoGroundError(InputError):
    """The scene has nothing to stand on at one of the kept configurations.

    Attributes:
        step: step that finds no candidate; -1 if the feet have no place to start from.
    """

    def __init__(self, message: str, step: int) -> None:
        super().__init__(message)
        self.step = step

    def __reduce__(self) -> tuple:
        return type(self), (str(self), self.step)


DEFAULT_STEPPING = Stepping()


def problem_from_guide(
    guide: GuidePath,
    scene: Scene,
    robot: str,
    stepping: Stepping = DEFAULT_STEPPING,
    *,
    polytopes: StepPolytopes | None = None,
) -> ContactProblem:
    """Make one step of each kept configuration; its foot is oriented as the root is there.

    The feet first stand on the ground beside the first configuration; configurations N, 2 N, ...
    and the last of the guide are kept, where N is `stepping.every`. Feet move in turn, in the
    robot's order.

    Args:
        guide: guide path to follow.
        scene: scene whose surfaces the guide crosses.
        robot: name of the robot.
        stepping: how the guide path becomes steps.
        polytopes: step polytopes to use instead of the robot's own.

    Raises:
        InputError: the guide is too short or not finite.
        NoGroundError: the guide leaves the scene; says where.
    """
    _require_usable(guide)
    described = load_robot(robot)
    feet = described.foot_names
    turn = _first(described, feet, stepping.first_foot)
    surfaces = {
        name: make_surface(vertices, f"surface '{name}' of the scene")
        for name, vertices in scene.walkable.items()
    }
    initial = _initial(guide, surfaces, described)
    finder = _Finder(surfaces, described, stepping)
    steps, parts = [], {}
    for index in kept_configurations(len(guide), stepping.every):
        foot = feet[(turn + len(steps)) % len(feet)]
        found = finder.find(guide.position[index], float(guide.yaw[index]), foot)
        if not found:
            x, y, z = guide.position[index]
            raise NoGroundError(
                f"the guide leaves the scene: around configuration {index}, with its root at"
                f" ({x:.2f}, {y:.2f}, {z:.2f}), no surface is a candidate for {foot}",
                len(steps),
            )
        names = [_add(surfaces, parts, len(steps), *each) for each in found]
        steps.append(
            Step(
                foot,
                float(wrap_angle_on_host(guide.yaw[index])),
                tuple(names),
                guide.position[index],
            )
        )
    reach = load_step_polytopes(robot) if polytopes is None else polytopes
    return ContactProblem(
        robot=robot,
        model=stepping.model or default_model(feet, reach.com),
        surfaces=surfaces,
        initial=initial,
        steps=tuple(steps),
        polytopes=reach,
        half_sizes={foot: described.effector(foot).half_size for foot in feet},
        parts=parts,
    )


def kept_configurations(length: int, every: int) -> list[int]:
    """Return the configurations of a guide that steps are made of: every N-th, and the last.

    Args:
        length: number of configurations of the guide.
        every: number N: every N-th configuration is kept.
    """
    return [*range(every, length - 1, every), length - 1]


def _add(
    surfaces: dict[str, ContactSurface],
    parts: dict[str, str],
    step: int,
    whole: str,
    part: ContactSurface | None,
) -> str:
    """Add the part of a surface that is a candidate, unless it is the whole; return its name."""
    if part is None:
        return whole
    name = f"{whole}@{step}"
    while name in surfaces:  # a scene itself may use such names
        name += "'"
    surfaces[name], parts[name] = part, whole
    return name


class _Finder:
    """Finds the candidate surfaces around a root, and the part of each that is near enough."""

    def __init__(
        self,
        surfaces: dict[str, ContactSurface],
        robot: Robot,
        stepping: Stepping,
    ) -> None:
        self.names = list(surfaces)
        self.corners = [surface.vertices for surface in surfaces.values()]
        self.packed = pack_polygons(self.corners)
        reach = [robot.limbs[index].range_of_motion for index in robot.feet]
        if stepping.candidates == "window":
            low = min(float(each.vertices[:, 2].min()) for each in reach)
            high = max(float(each.vertices[:, 2].max()) for each in reach)
            half = 0.5 * stepping.window
            square = Polytope.from_box(Box((-half, -half, low), (half, half, high)))
            reach = [square] * len(reach)
        self.reach: dict[str, Polytope] = dict(zip(robot.foot_names, reach, strict=True))

    def find(
        self, root: np.ndarray, yaw: float, foot: str
    ) -> list[tuple[str, ContactSurface | None]]:
        """Return names, nearest first, with the part of each in reach; None for a whole surface."""
        turn, reach = rotation(yaw), self.reach[foot]
        meets = np.flatnonzero(polygons_meet_polytope((self.packed - root) @ turn, reach))
        found: list[tuple[float, str, ContactSurface | None]] = []
        for index in meets.tolist():
            local = (self.corners[index] - root) @ turn
            inside = clip_polygon(local, reach)
            part = None
            if inside is not local:
                if len(inside) < 3 or np.linalg.norm(polygon_area_vector(inside)) < LEAST_PART:
                    continue
                part = ContactSurface(inside @ turn.T + root)
            apart = float(np.linalg.norm(inside[:, :2].mean(axis=0)))
            found.append((apart, self.names[index], part))
        return [(name, part) for _, name, part in sorted(found, key=lambda each: each[0])]


def _initial(
    guide: GuidePath, surfaces: dict[str, ContactSurface], robot: Robot
) -> dict[str, FootPose]:
    """Stand each foot on the ground nearest to its reference place beside the first root."""
    yaw, root = float(wrap_angle_on_host(guide.yaw[0])), guide.position[0]
    legs = [robot.limbs[index].range_of_motion for index in robot.feet]
    lowest = min(float(reach.vertices[:, 2].min()) for reach in legs)
    poses = {}
    for foot in robot.foot_names:
        place = reference_foothold(robot, foot, root, yaw)
        found = [nearest_below(surface, place) for surface in surfaces.values()]
        reachable = [
            (aside, -float(point[2]), tuple(point.tolist()))
            for point, aside in found
            if aside <= MOST_ASIDE and lowest - 0.1 <= point[2] - root[2] <= 0.0
        ]
        if not reachable:
            raise NoGroundError(
                f"the guide starts where {foot} cannot stand: no surface lies within"
                f" {MOST_ASIDE:g} m of ({place[0]:.2f}, {place[1]:.2f}) and within a leg's length"
                f" below the root at {root[2]:.2f} m",
                -1,
            )
        _, _, point = min(reachable)  # the nearest; of those right below, the highest
        poses[foot] = FootPose(np.array(point), yaw)
    return poses


def nearest_below(
    surface: ContactSurface, place: Float[np.ndarray, " 3"]
) -> tuple[Float[np.ndarray, " 3"], float]:
    """Return the point of a surface that is horizontally nearest to a place, and its distance [m].

    A wall has no such point: its distance is infinite.
    """
    if abs(surface.normal[2]) < 1e-3:
        return place, math.inf
    corners, target = surface.vertices[:, :2], place[:2]
    along = np.roll(corners, -1, axis=0) - corners
    outside = along[:, 1] * (target - corners)[:, 0] - along[:, 0] * (target - corners)[:, 1]
    if (outside > 0.0).any():  # counter-clockwise from above: right of an edge is outside
        share = np.einsum("vk,vk->v", target - corners, along) / np.einsum("vk,vk->v", along, along)
        on_edges = corners + np.clip(share, 0.0, 1.0)[:, None] * along
        target = on_edges[np.argmin(np.linalg.norm(on_edges - place[:2], axis=1))]
    z = (surface.offset - surface.normal[:2] @ target) / surface.normal[2]
    return np.array([*target, z]), float(np.linalg.norm(target - place[:2]))


def _first(robot: Robot, feet: tuple[str, ...], first_foot: str | None) -> int:
    """Return the number of the foot that moves first."""
    if len(feet) < 2:
        raise InputError(
            f"robot '{robot.name}' has {len(feet)} feet; a step needs one that moves and one that"
            " stands"
        )
    if first_foot is None:
        return 0
    if first_foot not in feet:
        raise InputError(f"first foot must be {' or '.join(feet)}, not {first_foot!r}")
    return feet.index(first_foot)


def _require_usable(guide: GuidePath) -> None:
    if len(guide) < 2:
        raise InputError(f"the guide has {len(guide)} configurations; a step needs at least 2")
    if not (np.isfinite(guide.position).all() and np.isfinite(guide.yaw).all()):
        raise InputError("the guide's position or yaw holds a number that is not finite")
