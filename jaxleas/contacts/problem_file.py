"""Contact problems as files: JSON, with one sentence for every mistake."""

import math
from pathlib import Path
from typing import Any

import numpy as np

from jaxleas.contacts.polytopes import StepPolytopes, load_step_polytopes, read_polytopes
from jaxleas.contacts.problem import ContactProblem, FootPose, Step
from jaxleas.contacts.surfaces import ContactSurface, make_surface
from jaxleas.files import read_json, refuse_misspelt_keys, require_version, write_json
from jaxleas.robots import load_robot
from jaxleas.types import InputError

VERSION = 1
NEEDED = ("robot", "model", "surfaces", "initial", "phases")
KNOWN = (*NEEDED, "version", "polytopes", "foot_half_size", "parts")
OF_A_PHASE = ("foot", "yaw", "candidates", "root")
OTHER_ROTATIONS = ("rotation", "orientation", "quaternion", "roll", "pitch", "rpy", "R")
MAX_COORDINATE = 1e6  # [m]
MAX_PHASES = 10_000
ON_SURFACE = 1e-3  # a foot further [m] from every surface stands on none


def read_problem(path: str | Path) -> ContactProblem:
    """Read a contact problem from JSON.

    Raises:
        InputError: the file, or one entry in it (named), cannot be used.
    """
    return parse_problem(str(path), read_json(path))


def parse_problem(where: str, content: Any) -> ContactProblem:
    """Return the problem in a parsed JSON object.

    Args:
        where: name of the file, for messages.
        content: content of the file.

    Raises:
        InputError: an entry (named) cannot be used.
    """
    if not isinstance(content, dict):
        raise InputError(f"{where} is not a contact problem: it must be a JSON object")
    missing = [key for key in NEEDED if key not in content]
    if missing:
        raise InputError(f"{where} is not a contact problem: it lacks {', '.join(missing)}")
    refuse_misspelt_keys(where, content, KNOWN)
    require_version(content, VERSION, where)
    if not isinstance(content["robot"], str):
        raise InputError(f"{where}: robot must be a name, 'talos', not {content['robot']!r:.60}")
    model = content["model"]
    if model not in ("two_com", "feet"):
        raise InputError(f"{where}: model must be 'two_com' or 'feet', not {model!r:.60}")
    surfaces = _surfaces(where, content["surfaces"])
    initial = _initial(where, content["initial"], content["robot"])
    problem = ContactProblem(
        robot=content["robot"],
        model=model,
        surfaces=surfaces,
        initial=initial,
        steps=_phases(where, content["phases"], surfaces, tuple(initial)),
        polytopes=_polytopes(where, content, model, tuple(initial)),
        half_sizes=_half_sizes(where, content, tuple(initial)),
        parts=_parts(where, content.get("parts"), surfaces),
    )
    require_feet_on_surfaces(problem, where)
    return problem


def write_problem(path: str | Path, problem: ContactProblem) -> None:
    """Write a problem as JSON, whole or not at all."""
    polytopes = problem.polytopes
    named = polytopes.relative | {f"COM_in_{foot}": p for foot, p in polytopes.com.items()}
    write_json(
        path,
        {
            "version": VERSION,
            "robot": problem.robot,
            "model": problem.model,
            "surfaces": {name: each.vertices.tolist() for name, each in problem.surfaces.items()},
            "initial": {
                foot: {"position": pose.position.tolist(), "yaw": pose.yaw}
                for foot, pose in problem.initial.items()
            },
            "phases": [
                {
                    "foot": step.foot,
                    "yaw": step.yaw,
                    "candidates": list(step.candidates),
                    "root": None if step.root is None else step.root.tolist(),
                }
                for step in problem.steps
            ],
            "polytopes": {
                name: {"A": each.normals.tolist(), "b": each.offsets.tolist()}
                for name, each in named.items()
            },
            "foot_half_size": _half_sizes_to_json(problem),
            "parts": dict(problem.parts),
        },
    )


def require_feet_on_surfaces(problem: ContactProblem, where: str) -> None:
    """Refuse initial feet that stand on no surface of the problem.

    Raises:
        InputError: a foot stands on no surface; says which one, and how far the nearest surface is.
    """
    for foot, pose in problem.initial.items():
        gaps = {
            name: float(each.distance(pose.position)) for name, each in problem.surfaces.items()
        }
        nearest = min(gaps, key=lambda name: gaps[name])
        if gaps[nearest] > ON_SURFACE:
            x, y, z = pose.position
            raise InputError(
                f"{where}: initial {foot} at ({x:g}, {y:g}, {z:g}) stands on no surface; the"
                f" nearest, '{nearest}', is {gaps[nearest]:.3g} m away"
            )


def _surfaces(where: str, content: Any) -> dict[str, ContactSurface]:
    if not isinstance(content, dict) or not content:
        raise InputError(f"{where}: surfaces must be a non-empty object of name: [[x, y, z], ...]")
    return {name: _surface(f"{where}: surface '{name}'", each) for name, each in content.items()}


def _surface(where: str, content: Any) -> ContactSurface:
    if not isinstance(content, list):
        raise InputError(f"{where} must be a list of vertices [x, y, z]")
    return make_surface(np.array([_vector(where, each) for each in content]).reshape(-1, 3), where)


def _initial(where: str, content: Any, robot: str) -> dict[str, FootPose]:
    if not isinstance(content, dict) or not content:
        raise InputError(f"{where}: initial must say where each foot stands")
    poses = {}
    for foot in _effectors(where, list(content), robot):
        here, pose = f"{where}: initial {foot}", content[foot]
        if not isinstance(pose, dict) or not {"position", "yaw"} <= pose.keys():
            raise InputError(f"{here} must be an object with position and yaw")
        _refuse_other_rotations(here, pose)
        position = _vector(f"{here}: position", pose["position"])
        poses[foot] = FootPose(position, _yaw(here, pose["yaw"]))
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


def _phases(
    where: str, content: Any, surfaces: dict[str, ContactSurface], effectors: tuple[str, ...]
) -> tuple[Step, ...]:
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
    _refuse_other_rotations(where, content)
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
        yaw=_yaw(where, content["yaw"]),
        candidates=tuple(dict.fromkeys(names)),
        root=None if root is None else _vector(f"{where}: root", root),
    )


def _refuse_other_rotations(where: str, content: dict[str, Any]) -> None:
    """Refuse a rotation that would otherwise be ignored, as comments are."""
    for key in OTHER_ROTATIONS:
        if key in content:
            raise InputError(
                f"{where}: '{key}' is not read; rotations are about the vertical only: give yaw, in"
                " radians"
            )


def _polytopes(
    where: str, content: dict[str, Any], model: str, effectors: tuple[str, ...]
) -> StepPolytopes:
    given = content.get("polytopes")
    if given is None:
        return load_step_polytopes(content["robot"], effectors)
    return read_polytopes(f"{where}: polytopes", given, model, effectors)


def _half_sizes(
    where: str, content: dict[str, Any], effectors: tuple[str, ...]
) -> dict[str, tuple[float, float]]:
    """Return the half sizes of each effector: one pair is the value for all of them."""
    given = content.get("foot_half_size")
    if given is None:
        robot = load_robot(content["robot"])
        return {name: robot.effector(name).half_size for name in effectors}
    if not isinstance(given, dict):
        return dict.fromkeys(effectors, _half_size(f"{where}: foot_half_size", given))
    if set(given) != set(effectors):
        raise InputError(
            f"{where}: foot_half_size is of {', '.join(given) or 'no effector'}: give two numbers"
            f" [m] for all effectors, or for each of {', '.join(effectors)}"
        )
    return {
        name: _half_size(f"{where}: foot_half_size of {name}", given[name]) for name in effectors
    }


def _half_size(where: str, given: Any) -> tuple[float, float]:
    if not isinstance(given, list) or len(given) != 2 or not all(_is_number(x) for x in given):
        raise InputError(f"{where} must be two numbers [m], not {given!r:.60}")
    is_point = given[0] == given[1] == 0.0
    if not is_point and not all(0.0 < x < 1.0 for x in given):
        raise InputError(f"{where} {given} is not between 0 and 1 m, nor 0, 0 of a point foot")
    return float(given[0]), float(given[1])


def _half_sizes_to_json(problem: ContactProblem) -> list[float] | dict[str, list[float]]:
    """Return one pair where all effectors have it, as in files before, else one pair for each.

    One key holds both forms: an earlier version refuses the second one, but would skip a new key.
    """
    sizes = {name: list(problem.half_sizes[name]) for name in problem.effectors}
    first = next(iter(sizes.values()))
    return first if all(each == first for each in sizes.values()) else sizes


def _parts(where: str, content: Any, surfaces: dict[str, ContactSurface]) -> dict[str, str]:
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


def _vector(where: str, content: Any) -> np.ndarray:
    if (
        not isinstance(content, list)
        or len(content) != 3
        or any(isinstance(x, bool) or not isinstance(x, int | float) for x in content)
    ):
        raise InputError(f"{where} must be three numbers [x, y, z] in metres, not {content!r:.60}")
    if not all(abs(x) < MAX_COORDINATE for x in content):
        raise InputError(f"{where} {content!r:.60} is not finite, or beyond 1000 km")
    return np.array(content, dtype=np.float64)


def _yaw(where: str, content: Any) -> float:
    if not _is_number(content):
        raise InputError(
            f"{where}: yaw must be one finite number of radians, not {content!r:.60}; rotations"
            " are about the vertical only"
        )
    if abs(content) > 2 * math.pi:
        raise InputError(f"{where}: yaw {content:g} is beyond a full turn; give radians")
    return float(content)


def _is_number(content: Any) -> bool:
    """Return whether the content is a finite number, and no integer too large to be a float."""
    is_number = isinstance(content, int | float) and not isinstance(content, bool)
    return is_number and abs(content) < 1e300
