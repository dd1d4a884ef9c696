"""Robots by name: those of the package, and the user's own files."""

import difflib
import re
from functools import cache
from importlib import resources
from pathlib import Path

from jaxleas.robots.files import read_robot
from jaxleas.robots.robot import Robot
from jaxleas.types import InputError

DEFAULT_ROBOT = "talos"
"""Name of the robot of commands that name none, and of files from before robots were recorded."""
FOLDER = Path("robots")
"""Folder of the user's own robot files, in the working folder."""


@cache
def robot_names() -> tuple[str, ...]:
    """Return the names of the package's robots."""
    shipped = resources.files("jaxleas.robots") / "data"
    return tuple(
        sorted(file.name.removesuffix(".json") for file in shipped.iterdir() if _is_json(file.name))
    )


def load_robot(name: str) -> Robot:
    """Return a robot from the package, from the file `robots/<name>.json`, or from a path.

    Args:
        name: name of a robot, or path of its file, which ends in .json.

    Raises:
        InputError: there is no such robot, or its file does not describe it.
    """
    if name in robot_names():
        return _shipped(name)
    if _is_json(str(name)):
        return read_robot(name)
    file = FOLDER / f"{name}.json"
    # A name must not lead out of the folder, and files have no longer ones.
    if re.fullmatch(r"[\w-]{1,60}", str(name)) and file.is_file():
        return _require_name(read_robot(file), name, file)
    known = sorted({*robot_names(), *(path.stem for path in FOLDER.glob("*.json"))})
    near = difflib.get_close_matches(str(name).lower(), known, n=1)
    hint = f"; did you mean {near[0]}?" if near else ""
    raise InputError(
        f"there is no robot {name!r:.80}, only {', '.join(known)} and those that you describe in"
        f" {FOLDER}/ of the working folder or give as the path of a .json file{hint}"
    )


def known_robot(name: str) -> Robot | None:
    """Return a robot as `load_robot` does; None where it is not known here.

    A file may be of any robot, as long as it states all that is needed of it.
    """
    try:
        return load_robot(name)
    except InputError:
        return None


@cache
def _shipped(name: str) -> Robot:
    with resources.as_file(resources.files("jaxleas.robots") / "data" / f"{name}.json") as path:
        return read_robot(path)


def _is_json(name: str) -> bool:
    return name.endswith(".json")


def _require_name(robot: Robot, name: str, file: Path) -> Robot:
    if robot.name != name:
        raise InputError(f"{file} describes the robot {robot.name!r}; name the file after it")
    return robot
