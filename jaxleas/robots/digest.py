"""The digest of a robot's file: which robot labels were made for, exactly."""

import hashlib
from importlib import resources
from pathlib import Path

from jaxleas.robots.catalogue import FOLDER, load_robot, robot_names


def robot_digest(name: str) -> str:
    """Return the SHA-256 of the file that describes a robot.

    Args:
        name: name of a robot, or path of its file.

    Raises:
        InputError: there is no such robot.
    """
    load_robot(name)
    if name in robot_names():
        content = (resources.files("jaxleas.robots") / "data" / f"{name}.json").read_bytes()
    else:
        content = Path(name if name.endswith(".json") else FOLDER / f"{name}.json").read_bytes()
    return hashlib.sha256(content).hexdigest()
