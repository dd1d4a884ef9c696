"""Robots that differ from their file: friction of the feet, mass of the trunk."""

import copy
from dataclasses import dataclass
from typing import Any

import numpy as np
from jaxtyping import Float

from jaxleas.physics.bodies import Body
from jaxleas.physics.mujoco_extra import import_mujoco
from jaxleas.types import InputError


@dataclass(frozen=True, eq=False)
class Variation:
    """How each of N robots differs from its file.

    Attributes:
        friction: friction coefficient of the feet [1].
        trunk_mass: mass and inertia of the trunk over those of the file [1].

    Raises:
        InputError: a number is not positive, or the lengths differ.
    """

    friction: Float[np.ndarray, " N"]
    trunk_mass: Float[np.ndarray, " N"]

    def __post_init__(self) -> None:
        if self.friction.shape != self.trunk_mass.shape or self.friction.ndim != 1:
            raise InputError(
                f"frictions of shape {self.friction.shape} and trunk masses of shape"
                f" {self.trunk_mass.shape}: give one of each for every robot"
            )
        if not (np.isfinite([self.friction, self.trunk_mass]).all() and self._positive):
            raise InputError("frictions and trunk masses of robots must be positive numbers")

    def __len__(self) -> int:
        """Return the number of robots."""
        return len(self.friction)

    @property
    def _positive(self) -> bool:
        return bool((self.friction > 0.0).all() and (self.trunk_mass > 0.0).all())


def varied_model(model: Any, body: Body, friction: float, trunk_mass: float) -> Any:
    """Return a copy of a compiled model with another friction of the feet and mass of the trunk.

    Args:
        model: MuJoCo's model of a world with the robot.
        body: robot.
        friction: friction coefficient of the feet [1].
        trunk_mass: mass and inertia of the trunk over those of the file [1].
    """
    mujoco = import_mujoco()
    varied = copy.copy(model)
    for foot in body.feet:
        varied.geom(f"{foot}_FOOT").friction[0] = friction
    trunk = int(varied.jnt_bodyid[0])
    varied.body_mass[trunk] *= trunk_mass
    varied.body_inertia[trunk] *= trunk_mass
    mujoco.mj_setConst(varied, mujoco.MjData(varied))  # what follows from the masses
    return varied
