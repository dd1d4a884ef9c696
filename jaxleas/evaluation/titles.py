"""What cells and methods are called for people."""

from jaxleas.guide.registry import BASELINES

METHOD_TITLES = {
    **{name: each.title for name, each in BASELINES.items()},
    "rb_kino_rrt": "RB-Kino + RRT",
    "leas_p1": "LEAS-P1",
    "leas_p2_sampling": "LEAS-P2 (sampling)",
    "leas_p2_mip": "LEAS-P2 (MIP)",
    "leas_p2_sl1m": "LEAS-P2 (SL1M)",
}


def cell_title(name: str) -> str:
    """Return a cell's name for people."""
    return name.replace("_", " ")


def method_title(name: str) -> str:
    """Return a method's name for people."""
    return METHOD_TITLES.get(name, name)
