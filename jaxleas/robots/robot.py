"""What moves: a trunk, limbs with ranges of motion, and a few numbers."""

from dataclasses import dataclass

from jaxleas.geometry.boxes import Box
from jaxleas.geometry.polytopes import Polytope


@dataclass(frozen=True, eq=False)
class Limb:
    """One limb.

    Attributes:
        name: "left" or "right" for bipeds.
        range_of_motion: where its effector (the middle of the sole) can stand, in the root frame
            with the root upright [m].
    """

    name: str
    range_of_motion: Polytope


@dataclass(frozen=True, eq=False)
class Robot:
    """A legged robot as the steering method sees it.

    Attributes:
        name: what `load_robot` calls it.
        limbs: left before right.
        trunk: boxes around the body without its limbs, in the root frame [m].
        root_height: of the root above the ground in the reference configuration [m].
        walking_height: of the root above the ground along guide paths [m].
        mass: of the whole robot [kg].
        friction: between sole and ground [1].
        foot_half_size: half length and half width of the sole [m].
    """

    name: str
    limbs: tuple[Limb, ...]
    trunk: tuple[Box, ...]
    root_height: float
    walking_height: float
    mass: float
    friction: float
    foot_half_size: tuple[float, float]
