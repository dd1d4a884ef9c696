"""What gait planning knows of its robot: a box, and four point feet that reach around it."""

from typing import Annotated, Self

import numpy as np
from jaxtyping import Float
from pydantic import Field, model_validator

from jaxleas.configuration import Positive, Strict

FEET = ("LF", "RF", "LH", "RH")
"""Names of the feet, in the order of every array."""
AHEAD = np.array([1.0, 1.0, -1.0, -1.0])
LEFT = np.array([1.0, -1.0, 1.0, -1.0])
Offsets = tuple[float, float, float]


class QuadrupedConfig(Strict):
    """A quadruped; lengths from its centre of mass, x ahead and y left. Defaults: ANYmal B."""

    com_height: Positive = 0.45
    """Height of the centre of mass above the lowest foothold, h_com [m]."""
    nominal_ahead: Positive = 0.34
    """Distance of nominal footholds ahead of, and behind, the centre of mass [m]: beneath the hips'
    flexion axes."""
    nominal_aside: Positive = 0.2
    """Distance of nominal footholds to the left and right [m]."""
    reach_low: Offsets = (-0.25, -0.12, -0.03)
    """Smallest offset of a foot from its nominal place [m]; y is outwards. With `reach_high` a box
    whose every corner the leg (0.25 + 0.336 m) reaches from its hip."""
    reach_high: Offsets = (0.25, 0.12, 0.22)
    """Largest offset of a foot from its nominal place [m]."""
    trunk_half: tuple[Positive, Positive] = (0.2655, 0.135)
    """Half length and half width of the trunk [m]."""
    trunk_bottom: float = -0.017
    """Height of the trunk's lower side above the centre of mass [m]."""
    friction: Positive = 0.5
    """Friction coefficient of all contacts [1]."""
    force_limit: Positive = 1.17
    """Largest normal force of a foot [body weights]: 350 N of 30.475 kg."""
    acceleration_limit: Annotated[float, Field(gt=0.0)] = 10.0
    """Largest acceleration of the centre of mass along each axis [m/s^2]."""

    @model_validator(mode="after")
    def _is_box(self) -> Self:
        if any(not low < 0.0 < high for low, high in zip(*self.reach, strict=True)):
            raise ValueError(
                f"reach_low = {list(self.reach_low)} and reach_high = {list(self.reach_high)} must"
                " be below and above 0: nominal footholds must be within reach"
            )
        return self

    @property
    def reach(self) -> tuple[Offsets, Offsets]:
        """Smallest and largest offsets of a foot from its nominal place [m]."""
        return self.reach_low, self.reach_high

    @property
    def nominal(self) -> Float[np.ndarray, "4 3"]:
        """Nominal place of each foot from the centre of mass [m]."""
        x, y = self.nominal_ahead * AHEAD, self.nominal_aside * LEFT
        return np.stack([x, y, np.full(len(FEET), -self.com_height)], axis=1)

    @property
    def reach_box(self) -> tuple[Float[np.ndarray, "4 3"], Float[np.ndarray, "4 3"]]:
        """Lower and upper corner of the box of each foot from the centre of mass [m]."""
        low, high = (np.tile(each, (len(FEET), 1)) for each in self.reach)
        right = LEFT < 0.0  # outwards is to the right
        low[right, 1], high[right, 1] = -high[right, 1], -low[right, 1]
        return self.nominal + low, self.nominal + high
