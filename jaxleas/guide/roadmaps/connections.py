"""Connections: a steering method tried from many places to many others, in batches."""

from collections.abc import Sequence
from dataclasses import dataclass

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Bool, Float, Int

from jaxleas.guide.places import Places
from jaxleas.guide.rollout import RollOut, Trips, paths, roll_out
from jaxleas.guide.steering_method import SteeringMethod
from jaxleas.types import GuidePath, RootMotion

BATCH = 64
"""Connections walked in one compiled call: fewer leave the vector units idle."""
MOST_STEPS = 4000
"""Maximum number of steps of a whole guide path: 13 minutes at 0.2 s, 80 m at 0.1 m/s."""
FEWEST_WAYPOINTS = 16
"""Whole guide paths are compiled for this number of waypoints, or a power of two times it."""


@dataclass(frozen=True)
class Tried:
    """The answers to connections that were tried.

    Attributes:
        reached: whether the target was reached, valid all the way.
        arrival: root motion at the end.
    """

    reached: Bool[np.ndarray, " N"]
    arrival: RootMotion


class Connector:
    """A steering method on one terrain."""

    def __init__(self, places: Places, method: SteeringMethod, radius: float, steps: int):
        """Prepare.

        Args:
            places: places of the terrain where the robot can stand.
            method: steering method, whether it knows the terrain or not.
            radius: distance within which a target is reached [m].
            steps: maximum number of steps of one connection.
        """
        self.places, self.method, self.radius, self.steps = places, method, radius, steps

    def connect(self, starts: Sequence[RootMotion], targets: Float[np.ndarray, "N 2"]) -> Tried:
        """Walk from each start to its target.

        Args:
            starts: root motion of each robot at its start, without a batch axis.
            targets: target places x, y [m].
        """
        reached, arrivals = [], []
        for first in range(0, len(starts), BATCH):
            some = slice(first, first + BATCH)
            count = len(starts[some])
            padded = [*starts[some], *[starts[first]] * (BATCH - count)]
            motion = jax.tree.map(lambda *leaves: np.stack(leaves), *padded)
            aim = np.concatenate([targets[some], np.repeat(targets[first, None], BATCH - count, 0)])
            walked = self._walk(motion, self.places.standing_positions(aim)[:, None], self.steps)
            end = np.asarray(walked.end)
            reached.append(np.asarray(walked.reached)[:count])
            arrivals.append(_at(walked, end, count))
        arrival = jax.tree.map(lambda *leaves: np.concatenate(leaves), *arrivals)
        return Tried(np.concatenate(reached), arrival)

    def follow(
        self, start: RootMotion, waypoints: Float[np.ndarray, "W 2"]
    ) -> tuple[GuidePath, bool, bool]:
        """Walk one robot through all waypoints in one roll-out.

        Args:
            start: root motion at the start, without a batch axis.
            waypoints: waypoints x, y in order, the goal last [m].

        Returns:
            The guide path, whether it reached the goal, and whether it ended invalid.
        """
        size = FEWEST_WAYPOINTS
        while size < len(waypoints):
            size *= 2
        # The last waypoint is repeated: each copy is reached at once.
        repeated = np.concatenate([waypoints, np.repeat(waypoints[-1:], size - len(waypoints), 0)])
        motion = jax.tree.map(lambda leaf: np.asarray(leaf)[None], start)
        walked = self._walk(motion, self.places.standing_positions(repeated)[None], MOST_STEPS)
        (guide_path,) = paths(walked, self.places.env.config.limits.time_step)
        return guide_path, bool(walked.reached[0]), bool(walked.invalid[0])

    def _walk(self, motion: RootMotion, waypoints: np.ndarray, steps: int) -> RollOut:
        map_index = jnp.zeros(len(waypoints), jnp.int32)
        trips = Trips(self.places.atlas, map_index, motion, jnp.asarray(waypoints))
        return roll_out(self.places.env, self.method, trips, steps, self.radius)


def one(motion: RootMotion, index: int) -> RootMotion:
    """Return the root motion of one robot of a batch."""
    return jax.tree.map(lambda leaf: leaf[index], motion)


def _at(walked: RollOut, end: Int[np.ndarray, " N"], count: int) -> RootMotion:
    robot = np.arange(count)
    return jax.tree.map(lambda leaf: np.asarray(leaf)[robot, end[:count]], walked.motion)
