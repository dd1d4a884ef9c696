"""Surfaces, standing effectors and steps in the JSON of a contact problem."""

from typing import Any

import numpy as np

from jaxleas.contacts.problem import FootPose, Step
from jaxleas.contacts.problem_values import heading, refuse_other_rotations, vector
from jaxleas.contacts.surfaces import ContactSurface, make_surface
from jaxleas.files import refuse_misspelt_keys
from jaxleas.robots import load_robot
from jaxleas.types import InputError

OF_A_PHASE = ("foot", "yaw", "candidates", "root")
MAX_PHASES = 10_000


def problem_surfaces(where: str, content: Any) -> dict[str, ContactSurface]:
    """Return the surfaces by name."""
    if not isinstance(content, dict) or not content:
        raise InputError(f"{where}: surfaces must be a non-empty object of name: [[x, y, z], ...]")
    return {name: _surface(f"{where}: surface '{name}'", each) for name, each in content.items()}


def _surface(where: str, content: Any) -> ContactSurface:
    if not isinstance(content, list):
        raise InputError(f"{where} must be a list of vertices [x, y, z]")
    return make_surface(np.array([vector(where, each) for each in content]).reshape(-1, 3), where)


def initial_poses(where: str, content: Any, robot: str) -> dict[str, FootPose]:
    """Return the poses of the standing effectors, in the order of the robot."""
    if not isinstance(content, dict) or not content:
        raise InputError(f"{where}: initial must say where each foot stands")
    poses = {}
    for foot in _effectors(where, list(content), robot):
        here, pose = f"{where}: initial {foot}", content[foot]
        if not isinstance(pose, dict) or not {"position", "yaw"} <= pose.keys():
            raise InputError(f"{here} must be an object with position and yaw")
        refuse_other_rotations(here, pose)
        position = vector(f"{here}: position", pose["position"])
        poses[foot] = FootPose(position, heading(here, pose["yaw"]))
    return poses


def _effectors(where: str, named: list[str], robot: str) -> list[str]:
    """Return the effectors that stand, in the robot's order: all its feet, and palms where named.

    A robot that is not known here may have a problem with polytopes: then those named.
    """
    try:
        known = load_robot(robot)
    except InputError:
        if len(named) < 2 or not all(named):
            raise InputError(f"{where}: initial must say where two or more feet stand") from None
        return named
    feet = known.foot_names
    others = [each.name for each in known.effectors if each.name not in feet]
    wrong = [name for name in named if name not in (*feet, *others)]
    if wrong or not set(feet) <= set(named):
        palms = f" (and may say so of {', '.join(others)})" if others else ""
        raise InputError(
            f"{where}: initial must say where {' and '.join(feet)} stand{palms}, and no other foot"
        )
    return [each.name for each in known.effectors if each.name in named]


def problem_steps(
    where: str, content: Any, surfaces: dict[str, ContactSurface], effectors: tuple[str, ...]
) -> tuple[Step, ...]:
    """Return the steps, which the file calls phases."""
    if not isinstance(content, list) or not content:
        raise InputError(f"{where}: phases must be a list of at least one phase")
    if len(content) > MAX_PHASES:
        raise InputError(f"{where} has {len(content)} phases, more than {MAX_PHASES}")
    return tuple(
        _phase(f"{where}: phase {index}", each, surfaces, effectors)
        for index, each in enumerate(content)
    )


def _phase(
    where: str, content: Any, surfaces: dict[str, ContactSurface], effectors: tuple[str, ...]
) -> Step:
    if not isinstance(content, dict) or not {"foot", "yaw", "candidates"} <= content.keys():
        raise InputError(f"{where} must be an object with foot, yaw and candidates")
    refuse_misspelt_keys(where, content, OF_A_PHASE)
    refuse_other_rotations(where, content)
    if content["foot"] not in effectors:
        names = " or ".join(map(repr, effectors))
        raise InputError(f"{where}: foot must be {names}, not {content['foot']!r:.60}")
    names = content["candidates"]
    if not isinstance(names, list):
        raise InputError(f"{where}: candidates must be a list of names, not {names!r:.60}")
    if not names:
        raise InputError(f"{where} has no candidate surfaces: the foot could land nowhere")
    for name in names:
        if not isinstance(name, str) or name not in surfaces:
            raise InputError(f"{where}: candidate {name!r:.60} is no surface of this problem")
    root = content.get("root")
    return Step(
        foot=content["foot"],
        yaw=heading(where, content["yaw"]),
        candidates=tuple(dict.fromkeys(names)),
        root=None if root is None else vector(f"{where}: root", root),
    )


def parts_of_surfaces(
    where: str, content: Any, surfaces: dict[str, ContactSurface]
) -> dict[str, str]:
    """Return the whole surface of each part of one; empty where the file names no parts."""
    if content is None:
        return {}
    if not isinstance(content, dict):
        raise InputError(f"{where}: parts must be an object of name: the surface it is part of")
    for part, whole in content.items():
        if part not in surfaces or not isinstance(whole, str) or whole not in surfaces:
            raise InputError(
                f"{where}: parts says that {part!r:.60} is part of {whole!r:.60}, and one of them"
                " is no surface of this problem"
            )
        if whole in content:
            raise InputError(f"{where}: parts says that {whole!r:.60} is a whole and also a part")
    return dict(content)
