"""From a guide path and a scene to a contact problem: motion before contact (T 5.2.2, 5.2.3)."""

import numpy as np

from jaxleas.contacts.candidate_finder import CandidateFinder
from jaxleas.contacts.initial_feet import MOST_ASIDE, initial_feet, nearest_below
from jaxleas.contacts.models import default_model
from jaxleas.contacts.polytopes import StepPolytopes, load_step_polytopes
from jaxleas.contacts.problem import ContactProblem, Step
from jaxleas.contacts.stepping import (
    DEFAULT_STEPPING,
    EVERY,
    WINDOW,
    Candidates,
    NoGroundError,
    Stepping,
    kept_configurations,
)
from jaxleas.contacts.surfaces import ContactSurface, make_surface
from jaxleas.geometry import wrap_angle_on_host
from jaxleas.robots import Robot, load_robot
from jaxleas.terrain import Scene
from jaxleas.types import GuidePath, InputError

__all__ = [
    "EVERY",
    "MOST_ASIDE",
    "WINDOW",
    "Candidates",
    "NoGroundError",
    "Stepping",
    "kept_configurations",
    "nearest_below",
    "problem_from_guide",
]


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
    initial = initial_feet(guide, surfaces, described)
    finder = CandidateFinder(surfaces, described, stepping)
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
