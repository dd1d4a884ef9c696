"""Titles of cells and methods for readers, and the colours of methods."""

from jaxleas.contacts import PLANNERS, title_of
from jaxleas.guide import Method, method_of

_REFINED = "leas_p2_"  # followed by the name of the planner that the policy was refined against
_REFINED_COLOUR = "#c33d2e"


def cell_title(name: str) -> str:
    """Return a cell's title for readers."""
    return name.replace("_", " ")


def method_title(name: str) -> str:
    """Return a method's title for readers."""
    if name in refined_names():
        return f"LEAS-P2 ({title_of(name.removeprefix(_REFINED))})"
    method = method_of(name)
    return name if method is None else method.title


def method_colour(name: str) -> str:
    """Return a method's colour in pictures."""
    if name in refined_names():
        return _REFINED_COLOUR
    method = method_of(name)
    return Method.colour if method is None else method.colour


def refined_name(planner: str) -> str:
    """Return the name of the method that was refined against a planner."""
    return _REFINED + planner


def refined_names() -> tuple[str, ...]:
    """Return the names of the methods that were refined against built-in planners."""
    return tuple(map(refined_name, PLANNERS))
