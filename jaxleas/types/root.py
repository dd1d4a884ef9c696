"""The root (the floating base) and how it moves."""

from flax import struct
from jax import Array
from jaxtyping import Float


@struct.dataclass
class RootMotion:
    """Where the root is and how it moves, of one robot or of any batch of robots.

    The root stays upright (T 3.3.1): its orientation is a yaw about the world's z axis.

    Attributes:
        position: of the root in the world [m].
        velocity: of the root in the world [m/s].
        yaw: heading of the root [rad], 0 along the world's x axis, in [-pi, pi).
    """

    position: Float[Array, "*batch 3"]
    velocity: Float[Array, "*batch 3"]
    yaw: Float[Array, "*batch"]
