"""The robot that a file of guide paths records: whose walk it is, and whose legs may answer it."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Self

import numpy as np

from jaxleas.robots.catalogue import DEFAULT_ROBOT, load_robot
from jaxleas.robots.digest import robot_digest
from jaxleas.types import InputError

KEYS = ("robot", "robot_sha256", "walking_height")
"""Arrays of a guide path file that hold the record; files from before lack them."""
ALIKE = 0.05
"""Robots whose walking heights differ by less may stand in for each other, if that is asked [m]."""


@dataclass(frozen=True)
class RecordedRobot:
    """The robot that walked.

    Attributes:
        name: name of the robot, or path of its file.
        sha256: SHA-256 of its file.
        walking_height: height of its root above level ground [m].
    """

    name: str
    sha256: str
    walking_height: float

    @classmethod
    def of(cls, robot: str) -> Self:
        """Return the record of a robot.

        Args:
            robot: name of the robot, or path of its file.

        Raises:
            InputError: there is no such robot.
        """
        return cls(robot, robot_digest(robot), load_robot(robot).walking_height)

    @classmethod
    def from_arrays(cls, arrays: Mapping[str, np.ndarray], where: object) -> Self | None:
        """Return the record among a file's arrays; None in files from before.

        Args:
            arrays: arrays of the file.
            where: name of the file, for messages.

        Raises:
            InputError: the record is damaged.
        """
        found = [arrays[key] for key in KEYS if key in arrays]
        if not found:
            return None
        if len(found) != len(KEYS) or [(a.ndim, a.dtype.kind) for a in found] != [
            (0, "U"),
            (0, "U"),
            (0, "f"),
        ]:
            raise InputError(
                f"{where}: {', '.join(KEYS)} must be two texts and a number [m], or all be left out"
            )
        name, sha256, height = (each.item() for each in found)
        if not (name and 0.0 < height < np.inf):
            raise InputError(f"{where}: robot {name!r:.60} with a walking height of {height:g} m")
        return cls(name, sha256, height)

    def to_arrays(self) -> dict[str, np.ndarray]:
        """Return the record as arrays of a file."""
        return dict(
            zip(KEYS, map(np.array, (self.name, self.sha256, self.walking_height)), strict=True)
        )


@dataclass(frozen=True)
class PlannedRobot:
    """The robot whose contacts are planned, and a line to print where that is not plain.

    Attributes:
        name: name of the robot, or path of its file.
        note: line to print; empty where there is nothing to say.
    """

    name: str
    note: str = ""


def robot_for(recorded: RecordedRobot | None, given: str | None, where: object) -> PlannedRobot:
    """Return the robot to plan with for a file's guide paths.

    Args:
        recorded: robot that the file records; None in files from before.
        given: robot that a person named; None if none was named.
        where: name of the file, for messages.

    Raises:
        InputError: the file is another robot's, or its robot is not known here.
    """
    if recorded is None:
        return PlannedRobot(DEFAULT_ROBOT if given is None else given)
    name = recorded.name if given is None else given
    try:
        known = robot_digest(name)
    except InputError:
        if given is not None:
            raise
        raise InputError(
            f"{where} was walked by the robot {name!r}, which is not known here: give its file by"
            " --robot"
        ) from None
    if known == recorded.sha256:
        said = given is not None or name == DEFAULT_ROBOT
        return PlannedRobot(
            name, "" if said else f"{where} was walked by {name}, whose legs are taken"
        )
    return PlannedRobot(name, _stand_in(recorded, name, where))


def _stand_in(recorded: RecordedRobot, name: str, where: object) -> str:
    """Return a line on a robot, other than the recorded one, that can walk at its height."""
    height = load_robot(name).walking_height
    other = "another robot of this name" if name == recorded.name else f"robot {recorded.name!r}"
    if abs(height - recorded.walking_height) > ALIKE:
        raise InputError(
            f"{where} was walked by {other}, with its root {recorded.walking_height:g} m above"
            f" ground, and {name} walks at {height:g} m: give --robot the robot that walked it, or"
            f" walk it anew with {name}"
        )
    return f"{where} was walked by {other}; the legs of {name} are taken, which walks as high"
