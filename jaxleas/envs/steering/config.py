"""The constants of the steering task (T table 3.1)."""

import math
from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from jaxleas.conditions.named import STANDARD, NamedConditions
from jaxleas.configuration.bounds import Count, Fraction, NonNegative, Positive
from jaxleas.configuration.strict import Strict


class MotionLimits(Strict):
    """What the root may do in one time step (T sec. 3.2.3)."""

    time_step: Annotated[float, Field(gt=0.0, le=1.0)] = 0.2
    """Time between two configurations of the guide path, T [s]."""
    max_speed: Positive = 0.2
    """Bound on the norm of the velocity, v_max [m/s]."""
    max_acceleration: Positive = 0.08
    """Bound on the norm of the acceleration, a_max [m/s^2]."""
    max_turn_rate: Positive = math.pi / 9
    """Bound on the turn rate, omega_max [rad/s]."""


class RewardWeights(Strict):
    """Weights of the reward's five terms (T sec. 3.2.4)."""

    direction: NonNegative = 3.0
    """w_dir. The thesis has 1.0; 3.0 makes crossing pay clearly more than standing still."""
    orientation: NonNegative = 0.4
    """w_ori."""
    turn: NonNegative = 0.1
    """w_omega, on the squared turn rate."""
    acceleration: NonNegative = 0.1
    """w_acc, on the squared acceleration."""
    alive: NonNegative = 0.6
    """w_alive, for every valid configuration. The thesis has 1.0."""
    failure: NonNegative = 0.0
    """Taken off for an invalid configuration, beyond what not being alive any more costs. The
    thesis has none; training lets it grow (ppo.final_failure)."""


class SteeringConfig(Strict):
    """The steering environment."""

    robot: str = "talos"
    """Name of the robot."""
    observation: Literal["thesis144", "thesis145", "icra81"] = "thesis144"
    """Layout of the local height map: 10 x 14 (T table 3.1), the same and the number of surfaces
    around the robot (T 5.2.3), or 11 x 7 (I sec. III)."""
    height_low: float = -1.4
    """Heights are clipped from below here, z_min [m] relative to the root."""
    height_high: float = -0.2
    """Heights are clipped from above here, z_max [m] relative to the root."""
    desired_speed: Positive = 0.1
    """Speed at which the root should move towards the goal, v_desired [m/s]."""
    goal_radius: Positive = 0.2
    """The goal is reached within this distance [m] (T sec. 3.4.2)."""
    episode_steps: Count = 250
    """An episode is cut here [steps]. The thesis has 800: most of it is standing at dead ends, and
    what is hard, turning and setting foot on the transition, happens in the first hundred."""
    near_share: Fraction = 0.5
    """Share of episodes that begin right before what is to be crossed, where turning is hardest."""
    wander_share: Fraction = 0.2
    """Share of episodes that begin with a random goal, as all do once their link is crossed."""
    goal_steps: tuple[Count, Count] = (200, 800)
    """A goal lasts a random number of steps in this range, or until it is reached."""
    conditions: NamedConditions = STANDARD
    """What ends an episode where it fails: `reachability` (R), `strict_reachability` (R*),
    `collision` (C), one `{surrogate: FILE}`, and MODULE:CLASS of one's own, which --allow must
    repeat on the command line."""
    limits: MotionLimits = MotionLimits()
    reward: RewardWeights = RewardWeights()

    def under_standard_conditions(self) -> Self:
        """Return the same task under R* and C, by which policies are compared."""
        return self.model_copy(update={"conditions": STANDARD})

    @model_validator(mode="after")
    def _ordered(self) -> Self:
        if self.height_low >= self.height_high:
            raise ValueError(
                f"height_low = {self.height_low} must be below height_high = {self.height_high}"
            )
        low, high = self.goal_steps
        if low > high:
            raise ValueError(f"goal_steps = [{low}, {high}] must be [least, most]")
        return self
