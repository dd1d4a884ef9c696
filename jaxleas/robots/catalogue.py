"""Robots by name."""

import difflib
from collections.abc import Callable

from jaxleas.robots.robot import Robot
from jaxleas.robots.talos import load_talos
from jaxleas.types.errors import InputError

ROBOTS: dict[str, Callable[[], Robot]] = {"talos": load_talos}


def load_robot(name: str) -> Robot:
    """Return the robot called `name`.

    Raises:
        InputError: there is none of that name.
    """
    if name not in ROBOTS:
        near = difflib.get_close_matches(str(name).lower(), ROBOTS, n=1)
        hint = f"; did you mean {near[0]}?" if near else ""
        raise InputError(f"there is no robot {name!r}, only {', '.join(sorted(ROBOTS))}{hint}")
    return ROBOTS[name]()
