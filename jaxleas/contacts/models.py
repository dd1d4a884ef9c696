"""The model of contact problems where none is stated: the finest one that the robot allows."""

from collections.abc import Collection, Sequence

from jaxleas.contacts.problem import TWO, Model
from jaxleas.robots import load_robot


def default_model(effectors: Sequence[str], com: Collection[str]) -> Model:
    """Return two_com for two effectors with step polytopes of the centre of mass, else feet.

    Args:
        effectors: names of the effectors that step or stand.
        com: names of the effectors with a polytope of the centre of mass.
    """
    return "feet" if _obstacle(effectors, com) else "two_com"


def default_model_of(robot: str) -> Model:
    """Return the model of a robot's contact problems where none is stated.

    Args:
        robot: name of the robot.

    Raises:
        InputError: there is no such robot.
    """
    return default_model(*_described(robot))


def model_note(stated: Model | None, robot: str) -> str:
    """Return a line that says why the model is feet although nobody stated it; else "".

    Args:
        stated: model that was stated, or None.
        robot: name of the robot.

    Raises:
        InputError: there is no such robot.
    """
    obstacle = "" if stated is not None else _obstacle(*_described(robot))
    return f"contacts of {robot} are planned with model feet: {obstacle}" if obstacle else ""


def _described(robot: str) -> tuple[tuple[str, ...], tuple[str, ...]]:
    found = load_robot(robot)
    com = tuple(name for name in found.foot_names if f"COM_in_{name}" in found.steps)
    return found.foot_names, com


def _obstacle(effectors: Sequence[str], com: Collection[str]) -> str:
    """Return what stands against two_com, as a clause; empty for nothing."""
    if len(effectors) != TWO:
        return f"two_com is for two feet, not for {len(effectors)}"
    missing = [f"COM_in_{name}" for name in effectors if name not in com]
    if missing:
        return f"two_com needs step polytopes {' and '.join(missing)}, which are missing"
    return ""
