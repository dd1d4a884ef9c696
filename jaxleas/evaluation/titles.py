"""Titles of cells and methods for readers."""

from jaxleas.contacts.registry import PLANNERS, title_of
from jaxleas.guide.registry import BASELINES

METHOD_TITLES = {
    **{name: each.title for name, each in BASELINES.items()},
    "rb_kino_rrt": "RB-Kino + RRT",
    "leas_p1": "LEAS-P1",
}
_REFINED = "leas_p2_"  # followed by the name of the planner that the policy was refined against


def cell_title(name: str) -> str:
    """Return a cell's title for readers."""
    return name.replace("_", " ")


def method_title(name: str) -> str:
    """Return a method's title for readers."""
    if name in refined_names():
        return f"LEAS-P2 ({title_of(name.removeprefix(_REFINED))})"
    return METHOD_TITLES.get(name, name)


def refined_name(planner: str) -> str:
    """Return the name of the method that was refined against a planner."""
    return _REFINED + planner


def refined_names() -> tuple[str, ...]:
    """Return the names of the methods that were refined against built-in planners."""
    return tuple(map(refined_name, PLANNERS))
