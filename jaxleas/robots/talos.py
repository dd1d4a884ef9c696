"""Talos, the humanoid robot of the LEAS thesis (Stasse 2017, PAL Robotics)."""

from jaxleas.robots.catalogue import load_robot
from jaxleas.robots.robot import Robot


def load_talos() -> Robot:
    """Return Talos from the file that scripts/make_robot.py made from the published URDF."""
    return load_robot("talos")
