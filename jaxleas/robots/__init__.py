"""The robots: trunk, limbs, effectors, ranges of motion, mass; one file per robot."""

from jaxleas.robots.catalogue import DEFAULT_ROBOT, load_robot, robot_names
from jaxleas.robots.digest import robot_digest
from jaxleas.robots.effector import Effector
from jaxleas.robots.files import read_robot, write_robot
from jaxleas.robots.robot import Limb, Robot
from jaxleas.robots.talos import load_talos

__all__ = [
    "DEFAULT_ROBOT",
    "Effector",
    "Limb",
    "Robot",
    "load_robot",
    "load_talos",
    "read_robot",
    "robot_digest",
    "robot_names",
    "write_robot",
]
