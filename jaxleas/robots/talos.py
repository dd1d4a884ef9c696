"""Talos, the humanoid of the LEAS thesis (Stasse 2017, PAL Robotics)."""

from functools import cache
from importlib import resources

from jaxleas.robots.files import read_robot
from jaxleas.robots.robot import Robot


@cache
def load_talos() -> Robot:
    """Return Talos from the file that scripts/make_talos.py made from the published URDF."""
    shipped = resources.files("jaxleas.robots") / "data" / "talos.json"
    with resources.as_file(shipped) as path:
        return read_robot(path)
