"""Half sizes of the soles in the JSON of a contact problem: one pair, or one for each effector."""

from typing import Any

from jaxleas.contacts.problem import ContactProblem
from jaxleas.contacts.problem_values import is_number
from jaxleas.robots import load_robot
from jaxleas.types import InputError


def half_sizes_from_json(
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


def half_sizes_to_json(problem: ContactProblem) -> list[float] | dict[str, list[float]]:
    """Return one pair where all effectors have it, as in files before, else one pair for each.

    One key holds both forms: an earlier version refuses the second one, but would skip a new key.
    """
    sizes = {name: list(problem.half_sizes[name]) for name in problem.effectors}
    first = next(iter(sizes.values()))
    return first if all(each == first for each in sizes.values()) else sizes


def _half_size(where: str, given: Any) -> tuple[float, float]:
    if not isinstance(given, list) or len(given) != 2 or not all(is_number(x) for x in given):
        raise InputError(f"{where} must be two numbers [m], not {given!r:.60}")
    is_point = given[0] == given[1] == 0.0
    if not is_point and not all(0.0 < x < 1.0 for x in given):
        raise InputError(f"{where} {given} is not between 0 and 1 m, nor 0, 0 of a point foot")
    return float(given[0]), float(given[1])
