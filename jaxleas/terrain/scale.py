"""How large terrain is made for a robot: the published sizes are those for Talos.

A length of the generator's configuration carries what it grows with, as `Annotated` metadata; the
named scenes keep their proportions, and grow with the leg.
"""

from dataclasses import dataclass
from enum import Enum
from typing import Any, TypeVar

from pydantic import BaseModel
from pydantic.fields import FieldInfo

from jaxleas.robots import Robot

WALKING_HEIGHT, TRUNK_WIDTH, SOLE_LENGTH = 0.95, 0.6, 0.2
"""Height of Talos's root above the ground as it walks, width of its trunk, length of a sole [m]."""
_DIGITS = 3  # scaled lengths are rounded to millimetres, as the published ones are stated

Model = TypeVar("Model", bound=BaseModel)


class Follows(Enum):
    """What a length of terrain grows with."""

    LEG = "leg"
    """the leg: what is climbed or stepped over"""
    SOLE = "sole"
    """the larger of leg and sole: what one foot must fit on and the next step leave"""
    WIDTH = "width"
    """the trunk's width: what is just wide enough to walk on or through"""
    BODY = "body"
    """the larger of leg and trunk's width: room to stand and turn"""


@dataclass(frozen=True)
class Scale:
    """Size of a robot as a multiple of that of Talos.

    Attributes:
        leg: ratio of the walking heights [1].
        width: ratio of the trunks' widths [1].
        sole: ratio of the soles' lengths [1]; 0 for point feet.
    """

    leg: float = 1.0
    width: float = 1.0
    sole: float = 1.0

    def of(self, follows: Follows) -> float:
        """Return the factor of a length [1]."""
        match follows:
            case Follows.LEG:
                return self.leg
            case Follows.SOLE:
                return max(self.leg, self.sole)
            case Follows.WIDTH:
                return self.width
            case Follows.BODY:
                return max(self.leg, self.width)


PUBLISHED = Scale()
"""Scale of the published sizes."""


def scale_for(robot: Robot) -> Scale:
    """Return the scale of terrain for a robot; that for Talos is exactly `PUBLISHED`."""
    leg = robot.walking_height / WALKING_HEIGHT
    right = min((box.low[1] for box in robot.trunk), default=0.0)
    left = max((box.high[1] for box in robot.trunk), default=0.0)
    soles = [2.0 * each.half_size[0] for each in robot.effectors if each.stands]
    return Scale(leg, (left - right) / TRUNK_WIDTH or leg, max(soles, default=0.0) / SOLE_LENGTH)


def scaled(config: Model, scale: Scale) -> Model:
    """Return a configuration with each length that follows a robot's size multiplied.

    Lengths stay within the bounds of their fields.

    Args:
        config: configuration in published sizes.
        scale: scale of the robot.
    """
    if scale == PUBLISHED:
        return config
    changed: dict[str, Any] = {}
    for name, info in type(config).model_fields.items():
        value = getattr(config, name)
        if isinstance(value, BaseModel):
            changed[name] = scaled(value, scale)
        elif follows := next((each for each in info.metadata if isinstance(each, Follows)), None):
            changed[name] = _multiplied(value, scale.of(follows), info)
    return type(config).model_validate({**dict(config), **changed})


def _multiplied(value: Any, factor: float, info: FieldInfo) -> Any:
    if isinstance(value, tuple):
        return tuple(_multiplied(each, factor, info) for each in value)
    product = max(round(value * factor, _DIGITS), 10.0**-_DIGITS)
    low = max((each.ge for each in info.metadata if hasattr(each, "ge")), default=product)
    high = min((each.le for each in info.metadata if hasattr(each, "le")), default=product)
    return min(max(product, low), high)
