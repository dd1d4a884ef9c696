"""Robots by name: those that come with the package, and files in the working folder's `robots/`."""

import difflib
import re
from collections.abc import Callable
from pathlib import Path

from jaxleas.robots.files import read_robot
from jaxleas.robots.robot import Robot
from jaxleas.robots.talos import load_talos
from jaxleas.types.errors import InputError

FOLDER = Path("robots")
ROBOTS: dict[str, Callable[[], Robot]] = {"talos": load_talos}


def load_robot(name: str) -> Robot:
    """Return the robot called `name`: of the package, or of the file `robots/<name>.json`.

    Raises:
        InputError: there is none of that name, or its file does not describe it.
    """
    if name not in ROBOTS:
        file = FOLDER / f"{name}.json"
        # A name, never a way out of the folder.
        if re.fullmatch(r"[\w-]+", str(name)) and file.is_file():
            return _require_name(read_robot(file), name, file)
        near = difflib.get_close_matches(str(name).lower(), ROBOTS, n=1)
        hint = f"; did you mean {near[0]}?" if near else ""
        raise InputError(
            f"there is no robot {name!r}, only {', '.join(sorted(ROBOTS))} and those in {FOLDER}/"
            f" of the working folder{hint}"
        )
    return ROBOTS[name]()


def _require_name(robot: Robot, name: str, file: Path) -> Robot:
    if robot.name != name:
        raise InputError(f"{file} describes the robot {robot.name!r}; name the file after it")
    return robot
