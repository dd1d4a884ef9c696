"""The roll-outs of one method from the starts of one cell."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Int

from jaxleas.envs.steering import SteeringEnv
from jaxleas.evaluation.starts import Grounds, Starts
from jaxleas.guide import SteeringMethod, Trips, roll_out
from jaxleas.types import GuidePath


@dataclass(frozen=True)
class CellRollOut:
    """The roll-outs of one method from the starts of one cell, on the host.

    Attributes:
        starts: starts of the roll-outs, with their goals.
        position: positions of the roots [m]; constant after the end.
        yaw: heading [rad].
        velocity: velocities of the roots [m/s].
        valid: whether each configuration satisfies the condition.
        end: index of each roll-out's last configuration.
        reached: whether the goal was reached, valid all the way.
        invalid: whether an invalid configuration was met.
        refused: whether a surrogate foresaw failure; None where none was asked.
    """

    starts: Starts
    position: Float[np.ndarray, "N T+1 3"]
    yaw: Float[np.ndarray, "N T+1"]
    velocity: Float[np.ndarray, "N T+1 3"]
    valid: Bool[np.ndarray, "N T+1"]
    end: Int[np.ndarray, " N"]
    reached: Bool[np.ndarray, " N"]
    invalid: Bool[np.ndarray, " N"]
    refused: Bool[np.ndarray, " N"] | None = None

    def path(self, index: int) -> Float[np.ndarray, "T 3"]:
        """Return the root positions of one roll-out up to its end [m]."""
        return self.position[index, : self.end[index] + 1]

    def guide_path(self, index: int, time_step: float) -> GuidePath:
        """Return one roll-out up to its end, with `time_step` [s] between configurations."""
        return GuidePath.of_walk(self, self.valid, index, time_step)[: self.end[index] + 1]


def roll_out_cell(
    env: SteeringEnv, grounds: Grounds, method: SteeringMethod, starts: Starts, steps: int
) -> CellRollOut:
    """Return the roll-outs from every start of a cell, all at once."""
    trips = Trips(grounds.atlas, starts.map_index, starts.motion, starts.waypoints, grounds.sensed)
    result = roll_out(env, method, trips, steps, env.config.goal_radius)
    return CellRollOut(
        starts=starts,
        position=np.asarray(result.position),
        yaw=np.asarray(result.yaw),
        velocity=np.asarray(result.velocity),
        valid=np.asarray(result.valid),
        end=np.asarray(result.end),
        reached=np.asarray(result.reached),
        invalid=np.asarray(result.invalid),
        refused=None if env.foresight is None else np.asarray(result.refused),
    )
