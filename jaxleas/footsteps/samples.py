"""What is logged of walking robots, tick after tick."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from jaxleas.physics import Sensed


@dataclass(frozen=True, eq=False)
class Samples:
    """T ticks of one robot with E feet.

    Attributes:
        time: time since the beginning of its run [s].
        command: command in force [m/s, m/s, rad/s].
        feet: positions of the feet's middles [m].
        forces: normal forces on the feet [N].
        com: position of the centre of mass [m].
        com_velocity: velocity of the centre of mass [m/s].
        yaw: heading [rad].
        yaw_rate: turning rate [rad/s].
    """

    time: Float[np.ndarray, " T"]
    command: Float[np.ndarray, "T 3"]
    feet: Float[np.ndarray, "T E 3"]
    forces: Float[np.ndarray, "T E"]
    com: Float[np.ndarray, "T 3"]
    com_velocity: Float[np.ndarray, "T 3"]
    yaw: Float[np.ndarray, " T"]
    yaw_rate: Float[np.ndarray, " T"]


class SampleLog:
    """Logs of N robots, kept in arrays that are made once."""

    def __init__(self, ticks: int, robots: int, feet: int) -> None:
        self._width = 3 + 3 * feet + feet + 3 + 3 + 2
        self._values = np.empty((ticks, robots, 1 + self._width))
        self._feet = feet
        self._count = 0

    def add(self, sensed: Sensed, command: Float[np.ndarray, "N 3"]) -> None:
        """Keep what was measured in one tick."""
        row = self._values[self._count]
        robots = len(row)
        parts = (
            *(sensed.time[:, None], command, sensed.feet.reshape(robots, -1), sensed.forces),
            *(sensed.com, sensed.com_velocity, sensed.yaw[:, None], sensed.turning_rate[:, 2:]),
        )
        np.concatenate(parts, axis=1, out=row)
        self._count += 1

    def of(self, robot: int, ticks: int) -> Samples:
        """Return the first ticks of one robot."""
        feet = self._feet
        columns = np.cumsum([1, 3, 3 * feet, feet, 3, 3, 1])
        values = self._values[: min(ticks, self._count), robot]
        time, command, places, forces, com, velocity, yaw, rate = np.split(values, columns, axis=1)
        return Samples(
            *(time[:, 0], command, places.reshape(-1, feet, 3), forces, com, velocity),
            *(yaw[:, 0], rate[:, 0]),
        )
