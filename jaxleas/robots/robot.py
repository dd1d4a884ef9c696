"""Robots: a trunk, limbs with ranges of motion and effectors, and a few numbers."""

import difflib
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
from jaxtyping import Float

from jaxleas.geometry import Box, Polytope
from jaxleas.robots.effector import Effector, foot_of_limb
from jaxleas.robots.limb_model import Body, LimbModel
from jaxleas.types import InputError


@dataclass(frozen=True, eq=False)
class Limb:
    """A limb of a robot.

    Attributes:
        name: name of the limb: "left" or "right" for the legs of bipeds.
        range_of_motion: polytope of contact positions of the effector's middle, in the root frame
            with the root upright [m].
        effector: effector of the limb; None stands for a foot with the robot's `foot_half_size` and
            `friction`, which `Robot` then inserts.
        reference: middle of the effector in the root frame, in the reference configuration [m];
            None stands for the middle of the range of motion, at the reference height below the
            root for a foot.
        model: joints, masses and shapes of the limb, for planners that move joints; None if the
            robot's file has no model.
    """

    name: str
    range_of_motion: Polytope
    effector: Effector | None = None
    reference: tuple[float, float, float] | None = None
    model: LimbModel | None = None


@dataclass(frozen=True, eq=False)
class Robot:
    """A legged robot as steering methods and contact planners see it.

    Attributes:
        name: name by which `load_robot` finds it.
        limbs: limbs, left before right.
        trunk: boxes around the body without its limbs, in the root frame [m].
        root_height: height of the root above the ground in the reference configuration [m].
        walking_height: height of the root above the ground along guide paths [m].
        mass: mass of the whole robot [kg].
        friction: friction coefficient mu of feet without their own [1].
        foot_half_size: half length and half width of the soles of feet without their own [m].
        start_heights: lowest and highest start of an episode, relative to the walking height [m].
        contact_window: largest distance ahead of the root, and to a side of it, of the contacts of
            the next stretch of a walk; a surrogate sees the terrain within it [m].
        steps: polytopes of steps, by name: "RF_in_LF" is where the right foot can be in the frame
            of the left one, "COM_in_LF" where the centre of mass can be [m]; empty if the
            robot's file has none.
            body: mass of the part that is not a limb, for planners that move joints; None if the
            robot's file has no body.

    Raises:
        InputError: two limbs or two effectors share a name, or a number is out of range.
    """

    name: str
    limbs: tuple[Limb, ...]
    trunk: tuple[Box, ...]
    root_height: float
    walking_height: float
    mass: float
    friction: float
    foot_half_size: tuple[float, float]
    start_heights: tuple[float, float] = (-0.20, 0.07)
    contact_window: tuple[float, float] = (0.65, 0.45)
    steps: Mapping[str, Polytope] = field(default_factory=dict)
    body: Body | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "limbs", tuple(self._completed(limb) for limb in self.limbs))
        for kind, names in (
            ("limbs", [limb.name for limb in self.limbs]),
            ("effectors", [effector.name for effector in self.effectors]),
        ):
            twice = sorted({name for name in names if names.count(name) > 1})
            if twice:
                raise InputError(f"robot '{self.name}' has two {kind} called '{twice[0]}'")
        low, high = self.start_heights
        if not (np.isfinite([low, high]).all() and low <= high):
            raise InputError(
                f"robot '{self.name}': start_heights must be a lowest and a highest height above"
                f" the walking height [m], not {low}, {high}"
            )
        if not (np.isfinite(self.contact_window).all() and min(self.contact_window) > 0.0):
            raise InputError(
                f"robot '{self.name}': contact_window must be two positive distances [m], not"
                f" {self.contact_window}"
            )

    @property
    def effectors(self) -> tuple[Effector, ...]:
        """One effector per limb, in the order of the limbs."""
        return tuple(limb.effector for limb in self.limbs if limb.effector is not None)

    @cached_property
    def references(self) -> Float[np.ndarray, "E 3"]:
        """Middle of each effector in the root frame, in the reference configuration [m]."""
        places = [self._reference(*each) for each in zip(self.limbs, self.effectors, strict=True)]
        return np.array(places, dtype=np.float64).reshape(-1, 3)

    @property
    def feet(self) -> tuple[int, ...]:
        """Indices of the limbs that carry a walking robot."""
        return tuple(index for index, each in enumerate(self.effectors) if each.stands)

    @property
    def foot_names(self) -> tuple[str, ...]:
        """Names of the effectors that carry a walking robot, in the order of the limbs."""
        return tuple(self.effectors[index].name for index in self.feet)

    @property
    def legs(self) -> "tuple[Limb, ...]":
        """The limbs that carry a walking robot."""
        return tuple(self.limbs[index] for index in self.feet)

    def effector_index(self, name: str) -> int:
        """Return the index of an effector.

        Raises:
            InputError: the robot has no effector of that name.
        """
        names = [effector.name for effector in self.effectors]
        if name not in names:
            close = difflib.get_close_matches(name, names, n=1, cutoff=0.5)
            meant = f"; perhaps you meant {close[0]}" if close else ""
            raise InputError(
                f"robot '{self.name}' has no effector {name!r}{meant}; it has {', '.join(names)}"
            )
        return names.index(name)

    def effector(self, name: str) -> Effector:
        """Return an effector.

        Raises:
            InputError: the robot has no effector of that name.
        """
        return self.effectors[self.effector_index(name)]

    def _completed(self, limb: Limb) -> Limb:
        if limb.effector is not None:
            return limb
        return replace(limb, effector=foot_of_limb(limb.name, self.foot_half_size, self.friction))

    def _reference(self, limb: Limb, effector: Effector) -> tuple[float, float, float]:
        if limb.reference is not None:
            return limb.reference
        bounds = limb.range_of_motion.bounds
        x, y, z = (0.5 * (np.array(bounds.low) + np.array(bounds.high))).tolist()
        return (x, y, -self.root_height if effector.stands else z)
