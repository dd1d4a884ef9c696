"""The motion of the root (the floating base)."""

from flax import struct
from jax import Array
from jaxtyping import Float


@struct.dataclass
class RootMotion:
    """The position, velocity and heading of the root of one robot or of any batch of robots.

    The root stays upright (T 3.3.1): its orientation is a yaw about the world's z axis.

    Attributes:
        position: position of the root in the world [m].
        velocity: velocity of the root in the world [m/s].
        yaw: heading of the root [rad], 0 along the world's x axis, in [-pi, pi).
    """

    position: Float[Array, "*batch 3"]
    velocity: Float[Array, "*batch 3"]
    yaw: Float[Array, "*batch"]
