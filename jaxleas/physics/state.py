"""What physics says of a batch of robots: where they are, and what their sensors measured."""

from dataclasses import dataclass, fields
from typing import Self

import numpy as np
from jaxtyping import Bool, Float

from jaxleas.physics.bodies import FREE_JOINT

ROOT_SPEEDS = 6
"""Number of speeds of the root: velocity in the world, turning rate in the root's frame."""


@dataclass(frozen=True, eq=False)
class BodyState:
    """Coordinates and speeds of N robots with J joints.

    Attributes:
        time: time since the start [s].
        coordinates: position of the root in the world [m], its quaternion (w, x, y, z), and the
            angles of the joints [rad].
        speeds: velocity of the root in the world [m/s], its turning rate in its own frame [rad/s],
            and the speeds of the joints [rad/s].
    """

    time: Float[np.ndarray, " N"]
    coordinates: Float[np.ndarray, "N 7+J"]
    speeds: Float[np.ndarray, "N 6+J"]

    def __len__(self) -> int:
        """Return the number of robots."""
        return len(self.time)

    @property
    def position(self) -> Float[np.ndarray, "N 3"]:
        """Position of the root in the world [m]."""
        return self.coordinates[:, :3]

    @property
    def quaternion(self) -> Float[np.ndarray, "N 4"]:
        """Orientation of the root in the world (w, x, y, z)."""
        return self.coordinates[:, 3:FREE_JOINT]

    @property
    def angles(self) -> Float[np.ndarray, "N J"]:
        """Angles of the joints [rad]."""
        return self.coordinates[:, FREE_JOINT:]

    @property
    def velocity(self) -> Float[np.ndarray, "N 3"]:
        """Velocity of the root in the world [m/s]."""
        return self.speeds[:, :3]

    @property
    def turning_rate(self) -> Float[np.ndarray, "N 3"]:
        """Turning rate of the root in its own frame [rad/s]."""
        return self.speeds[:, 3:ROOT_SPEEDS]

    @property
    def joint_speeds(self) -> Float[np.ndarray, "N J"]:
        """Speeds of the joints [rad/s]."""
        return self.speeds[:, ROOT_SPEEDS:]

    def replaced(self, where: Bool[np.ndarray, " N"], other: Self) -> Self:
        """Return these states, with those of `other` where a mask is true."""
        return type(self)(
            *(
                np.where(where.reshape(-1, *[1] * (mine.ndim - 1)), theirs, mine)
                for mine, theirs in (
                    (getattr(self, each.name), getattr(other, each.name)) for each in fields(self)
                )
            )
        )


@dataclass(frozen=True, eq=False)
class Sensed:
    """What the sensors of N robots with E feet measured, all at one instant.

    Attributes:
        time: instant of the measurement, one physics step before the state [s].
        feet: positions of the feet's middles in the world [m].
        forces: normal forces on the feet, 0 in the air [N].
        com: position of the centre of mass in the world [m].
        com_velocity: velocity of the centre of mass in the world [m/s].
        quaternion: orientation of the root in the world (w, x, y, z).
        turning_rate: turning rate of the root in the world [rad/s].
    """

    time: Float[np.ndarray, " N"]
    feet: Float[np.ndarray, "N E 3"]
    forces: Float[np.ndarray, "N E"]
    com: Float[np.ndarray, "N 3"]
    com_velocity: Float[np.ndarray, "N 3"]
    quaternion: Float[np.ndarray, "N 4"]
    turning_rate: Float[np.ndarray, "N 3"]

    @property
    def yaw(self) -> Float[np.ndarray, " N"]:
        """Heading of the root's x axis, seen from above [rad]."""
        w, x, y, z = (self.quaternion[:, index] for index in range(4))
        return np.arctan2(2.0 * (x * y + w * z), 1.0 - 2.0 * (y * y + z * z))


def sensed_from(time: Float[np.ndarray, " N"], values: Float[np.ndarray, "N S"]) -> Sensed:
    """Return measurements from the sensors' values, in the order of a robot's file.

    Args:
        time: instant of the measurement [s].
        values: feet's positions and forces, then the sensors of the root.
    """
    feet = (values.shape[1] - _ROOT_VALUES) // 4
    places, forces, com, velocity, quaternion, turning = np.split(
        values, np.cumsum([3 * feet, feet, 3, 3, 4]), axis=1
    )
    return Sensed(time, places.reshape(-1, feet, 3), forces, com, velocity, quaternion, turning)


_ROOT_VALUES = 3 + 3 + 4 + 3
