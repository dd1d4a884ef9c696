"""The values of a roll-out: where robots are to go, and how they went."""

from flax import struct
from jax import Array
from jaxtyping import Bool, Float, Int

from jaxleas.terrain import Atlas, SensedAtlas
from jaxleas.types import RootMotion


@struct.dataclass
class Trips:
    """The starts and the waypoints of N robots.

    Attributes:
        atlas: terrains to walk on.
        map_index: terrain of each robot.
        start: root motion of each robot at its start.
        waypoints: points to reach one after another, the goal last [m]: x, y in the world, and the
            root's height wanted there.
        sensed: maps as the robots and their guard see them; None: they see the terrain itself.
    """

    atlas: Atlas
    map_index: Int[Array, " N"]
    start: RootMotion
    waypoints: Float[Array, "N W 3"]
    sensed: SensedAtlas | None = None


@struct.dataclass
class RollOut:
    """N walks of up to T steps; configurations after a walk's end repeat the last one.

    Attributes:
        position: position of the root in the world [m].
        yaw: heading [rad].
        velocity: velocity of the root in the world [m/s].
        margin: margin of the environment's condition [m].
        valid: whether each configuration's margin is at least 0.
        end: index of the last configuration.
        reached: whether the last waypoint was reached with every configuration valid.
        invalid: whether the last configuration violates the condition.
        refused: whether the environment's foresight refused the configuration that would have come
            next.
    """

    position: Float[Array, "N T+1 3"]
    yaw: Float[Array, "N T+1"]
    velocity: Float[Array, "N T+1 3"]
    margin: Float[Array, "N T+1"]
    valid: Bool[Array, "N T+1"]
    end: Int[Array, " N"]
    reached: Bool[Array, " N"]
    invalid: Bool[Array, " N"]
    refused: Bool[Array, " N"]

    @property
    def motion(self) -> RootMotion:
        """The root motions, [N, T+1]."""
        return RootMotion(self.position, self.velocity, self.yaw)

    @property
    def stopped(self) -> Bool[Array, " N"]:
        """Whether a walk ended valid without reaching the goal: out of time, or refused."""
        return ~(self.reached | self.invalid)
