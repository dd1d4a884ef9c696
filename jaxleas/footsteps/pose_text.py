"""Poses as users write them on a command line: X,Y or X,Y,YAW."""

import numpy as np

from jaxleas.footsteps.walking_state import Goal
from jaxleas.types import InputError


def parse_pose(text: str, option: str, speed: float = np.inf) -> Goal:
    """Return the pose that X,Y or X,Y,YAW names [m, rad]; without YAW every heading will do.

    Args:
        text: what was given.
        option: option that it was given for, for messages.
        speed: largest speed of a robot that counts as there [m/s].

    Raises:
        InputError: the text is no pose.
    """
    try:
        numbers = [float(each) for each in text.split(",")]
    except ValueError:
        numbers = []
    if len(numbers) not in (2, 3) or not np.isfinite(numbers).all():
        raise InputError(f"{option} is '{text}'; give X,Y or X,Y,YAW in metres and radians: 2,0,0")
    if len(numbers) == 3:
        return Goal(*numbers, speed=speed)
    return Goal(*numbers, angle=float(np.pi), speed=speed)
