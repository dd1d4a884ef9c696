"""Contact problems as files: JSON, with one sentence for every mistake."""

from pathlib import Path
from typing import Any

from jaxleas.contacts.polytopes import StepPolytopes, load_step_polytopes, read_polytopes
from jaxleas.contacts.problem import ContactProblem
from jaxleas.contacts.problem_entries import (
    initial_poses,
    parts_of_surfaces,
    problem_steps,
    problem_surfaces,
)
from jaxleas.contacts.problem_half_sizes import half_sizes_from_json, half_sizes_to_json
from jaxleas.files import read_json, refuse_misspelt_keys, require_version, write_json
from jaxleas.types import InputError

VERSION = 1
NEEDED = ("robot", "model", "surfaces", "initial", "phases")
KNOWN = (*NEEDED, "version", "polytopes", "foot_half_size", "parts")
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
    surfaces = problem_surfaces(where, content["surfaces"])
    initial = initial_poses(where, content["initial"], content["robot"])
    problem = ContactProblem(
        robot=content["robot"],
        model=model,
        surfaces=surfaces,
        initial=initial,
        steps=problem_steps(where, content["phases"], surfaces, tuple(initial)),
        polytopes=_polytopes(where, content, model, tuple(initial)),
        half_sizes=half_sizes_from_json(where, content, tuple(initial)),
        parts=parts_of_surfaces(where, content.get("parts"), surfaces),
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
            "foot_half_size": half_sizes_to_json(problem),
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


def _polytopes(
    where: str, content: dict[str, Any], model: str, effectors: tuple[str, ...]
) -> StepPolytopes:
    given = content.get("polytopes")
    if given is None:
        return load_step_polytopes(content["robot"], effectors)
    return read_polytopes(f"{where}: polytopes", given, model, effectors)
