"""The digest of a robot's file: which robot labels were made for, exactly."""

import hashlib
from importlib import resources

from jaxleas.robots.catalogue import FOLDER, load_robot


def robot_digest(name: str) -> str:
    """Return the SHA-256 of the file that describes a robot.

    Raises:
        InputError: there is no such robot.
    """
    load_robot(name)
    shipped = resources.files("jaxleas.robots") / "data" / f"{name}.json"
    file = shipped if shipped.is_file() else FOLDER / f"{name}.json"
    return hashlib.sha256(file.read_bytes()).hexdigest()
