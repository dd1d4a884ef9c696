"""What a walking controller is: a velocity command in, joint torques or targets out."""

from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from jaxtyping import Float

from jaxleas.physics import BodyState, Sensed
from jaxleas.types import ControllerIdentity


@dataclass(frozen=True, eq=False)
class JointCommand:
    """What N robots' J joints are to do: torque + stiffness (target - angle) - damping speed.

    Attributes:
        torques: torques of the joints [Nm].
        targets: angles that the joints are drawn to [rad].
        stiffness: stiffness of the joints [Nm/rad].
        damping: damping of the joints [Nm s/rad].
    """

    torques: Float[np.ndarray, "N J"]
    targets: Float[np.ndarray, "N J"]
    stiffness: Float[np.ndarray, " J"] | float = 0.0
    damping: Float[np.ndarray, " J"] | float = 0.0

    def torques_at(self, state: BodyState) -> Float[np.ndarray, "N J"]:
        """Return the torques in a state [Nm]."""
        drawn = self.stiffness * (self.targets - state.angles)
        return self.torques + drawn - self.damping * state.joint_speeds


class Controller(Protocol):
    """A walking controller of a batch of robots.

    Its memory is a value that it alone understands: a dataclass or a tuple of arrays whose first
    axis counts the robots. Planners see neither memory nor command of the joints, only footsteps
    that physics measures.

    Attributes:
        identity: what its footsteps and models are those of.
        period: time between two decisions [s].
    """

    identity: ControllerIdentity
    period: float

    def start(self, state: BodyState) -> Any:
        """Return the memory of robots that stand at rest."""
        ...

    def act(
        self,
        memory: Any,
        state: BodyState,
        sensed: Sensed,
        command: Float[np.ndarray, "N 3"],
    ) -> tuple[Any, JointCommand]:
        """Return the next memory, and what the joints are to do until the next decision.

        Args:
            memory: memory after the last decision.
            state: state now.
            sensed: latest measurements.
            command: forward and sideways speed [m/s] and turning rate [rad/s] in the robot's frame.
        """
        ...
