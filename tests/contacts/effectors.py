"""Toy robots with other effectors than two feet, and the floor and wall that they touch."""

import numpy as np

from jaxleas.geometry import Box, Polytope
from jaxleas.robots import Effector, Limb, Robot
from jaxleas.robots.effector import Kind
from tests.contacts.worlds import rectangle

PLACES = {"FL": (0.25, 0.2), "FR": (0.25, -0.2), "H": (-0.3, 0.0)}
"""Where the feet of the three-legged robot stand below its root [m]."""
FLOOR = np.array(rectangle(-2.0, 6.0, -1.5, 1.5))
WALL = np.array([[0.5, 1.0, 0.0], [0.5, -1.0, 0.0], [0.5, -1.0, 2.0], [0.5, 1.0, 2.0]])
"""Before the robot: counter-clockwise as the robot sees it, so that its normal is -x."""


def box(low: tuple[float, float, float], high: tuple[float, float, float]) -> Polytope:
    return Polytope.from_box(Box(low, high))


def limb(name: str, place: tuple[float, float, float], reach: float, kind: Kind = "foot") -> Limb:
    low, high = np.array(place) - reach, np.array(place) + reach
    half_size = (0.0, 0.0) if kind == "point_foot" else (0.05, 0.04)
    return Limb(
        name,
        box(tuple(low.tolist()), tuple(high.tolist())),
        Effector(name, kind, half_size, 0.7),
        place,
    )


def tripod(reach: float = 0.25) -> Robot:
    """Return a robot with three point feet."""
    steps = {}
    for one, (x, y) in PLACES.items():
        for other, (a, b) in PLACES.items():
            if one != other:
                low = (x - a - reach, y - b - reach, -0.3)
                steps[f"{one}_in_{other}"] = box(low, (x - a + reach, y - b + reach, 0.3))
    return Robot(
        name="tripod",
        limbs=tuple(limb(name, (*xy, -0.6), 0.3, "point_foot") for name, xy in PLACES.items()),
        trunk=(Box((-0.3, -0.2, -0.1), (0.3, 0.2, 0.1)),),
        root_height=0.6,
        walking_height=0.6,
        mass=30.0,
        friction=0.7,
        foot_half_size=(0.05, 0.04),
        steps=steps,
    )


def leaner() -> Robot:
    """Return a robot with two feet and a palm in front."""
    limbs = (
        limb("LF", (0.0, 0.1, -0.9), 0.3),
        limb("RF", (0.0, -0.1, -0.9), 0.3),
        limb("RH", (0.4, -0.2, 0.2), 0.3, "palm"),
    )
    wide = box((-1.0, -1.0, -1.5), (1.0, 1.0, 1.5))
    names = [each.name for each in limbs]
    return Robot(
        name="leaner",
        limbs=limbs,
        trunk=(Box((-0.1, -0.2, -0.1), (0.1, 0.2, 0.6)),),
        root_height=0.9,
        walking_height=0.9,
        mass=60.0,
        friction=0.7,
        foot_half_size=(0.05, 0.04),
        steps={f"{a}_in_{b}": wide for a in names for b in names if a != b},
    )
