"""Kinematics of the legs of a batch of robots, all legs at once."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from jaxleas.physics import Body


@dataclass(frozen=True, eq=False)
class LegPosture:
    """Where the feet are in the root frame, and how the joints move them.

    Attributes:
        feet: positions of the feet [m].
        jacobians: velocity of each foot over the speed of each joint of its leg [m].
    """

    feet: Float[np.ndarray, "N E 3"]
    jacobians: Float[np.ndarray, "N E 3 J"]


class LegKinematics:
    """Forward kinematics of a robot whose legs have equally many joints."""

    def __init__(self, body: Body) -> None:
        self._offsets = np.stack([leg.offsets for leg in body.legs], axis=1)
        axes = np.stack([leg.axes for leg in body.legs], axis=1)
        x, y, z = np.moveaxis(axes, -1, 0)
        zero = np.zeros_like(x)
        rows = [[zero, -z, y], [z, zero, -x], [-y, x, zero]]
        self._axes = axes
        self._cross = np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)
        self._cross_squared = self._cross @ self._cross

    def posture(self, angles: Float[np.ndarray, "N E*J"]) -> LegPosture:
        """Return the posture of the legs.

        Args:
            angles: angles of the joints, leg after leg [rad].
        """
        joints, legs = self._axes.shape[:2]
        each = angles.reshape(-1, legs, joints)
        sines, cosines = np.sin(each), 1.0 - np.cos(each)
        frame = np.broadcast_to(np.eye(3), (len(angles), legs, 3, 3))
        place = np.broadcast_to(self._offsets[0], (len(angles), legs, 3))
        origins, axes = [place], [np.broadcast_to(self._axes[0], place.shape)]
        for joint in range(joints):
            # Rodrigues: I + sin(a) [axis] + (1 - cos(a)) [axis]^2
            turn = (
                np.eye(3)
                + sines[..., joint, None, None] * self._cross[joint]
                + cosines[..., joint, None, None] * self._cross_squared[joint]
            )
            frame = frame @ turn
            place = place + (frame @ self._offsets[joint + 1][..., None])[..., 0]
            if joint + 1 < joints:
                origins.append(place)
                axes.append((frame @ self._axes[joint + 1][..., None])[..., 0])
        arms = place[..., None, :] - np.stack(origins, axis=-2)
        return LegPosture(place, np.swapaxes(cross(np.stack(axes, axis=-2), arms), -1, -2))


def cross(
    one: Float[np.ndarray, "*batch 3"], other: Float[np.ndarray, "*batch 3"]
) -> Float[np.ndarray, "*batch 3"]:
    """Return cross products; NumPy's own takes several times as long for few vectors."""
    a, b, c = one[..., 0], one[..., 1], one[..., 2]
    x, y, z = other[..., 0], other[..., 1], other[..., 2]
    return np.stack([b * z - c * y, c * x - a * z, a * y - b * x], axis=-1)
