"""Talos, the humanoid robot of the LEAS thesis (Stasse 2017, PAL Robotics)."""

from jaxleas.robots.catalogue import load_robot
from jaxleas.robots.robot import Robot


def load_talos() -> Robot:
    """Return Talos from the file made of the published URDF and the options beside it."""
    return load_robot("talos")
