"""The constants of the steering task (T table 3.1)."""

import math
from collections.abc import Mapping
from typing import Annotated, Any, ClassVar, Literal, Self

from pydantic import Field, model_validator

from jaxleas.conditions import STANDARD, NamedConditions
from jaxleas.conditions import pinned as pinned_conditions
from jaxleas.configuration import Count, Fraction, NonNegative, Positive, Strict
from jaxleas.envs import Ball, Interval, Mirror, Normal, Part, Signature, TaskConfig
from jaxleas.envs.steering.layout import MIRROR_ACTION_SIGN, layout_named
from jaxleas.envs.steering.scaling import affine_scaling
from jaxleas.envs.steering.suited import HIGHEST, LOWEST, suited_to
from jaxleas.robots import DEFAULT_ROBOT, load_robot


class MotionLimits(Strict):
    """Limits on the root's motion in one time step (T sec. 3.2.3)."""

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
    """Penalty for an invalid configuration at the start of training, on top of the lost reward for
    being alive. The thesis has no such penalty."""
    final_failure: NonNegative = 60.0
    """Value to which `failure` grows linearly. At first falling must be cheap, or no policy learns
    to step onto a bridge; in the end it must cost much, or turning while walking backwards towards
    an edge pays although one in ten falls."""


class GuardConfig(Strict):
    """The guard of a policy's roll-outs, which brakes before what R* and C refuse."""

    enabled: bool = False
    """Whether a command is obeyed only where the robot could still brake to rest, valid all the
    way; otherwise it does not turn, or only rises or sinks, or brakes. Training is not guarded:
    what is never punished is not learned."""
    spare: Annotated[float, Field(ge=0.0, le=0.08)] = 0.03
    """Room that it leaves [m]: the trunk counts as this much larger to each side, and the square
    under the root as this much smaller. Maps have cells of some centimetres."""


class SteeringConfig(TaskConfig):
    """The steering environment."""

    swept: ClassVar[tuple[str, ...]] = tuple(
        f"reward.{name}" for name in RewardWeights.model_fields
    )
    moved: ClassVar[Mapping[str, str]] = {"ppo.final_failure": "env.reward.final_failure"}

    task: Literal["steering"] = "steering"  # type: ignore[assignment]
    robot: str = DEFAULT_ROBOT
    """Name of the robot. For another one than Talos, configurations have other defaults: heights
    seen from the root, and the sizes of the generator's terrain."""
    observation: Literal["thesis144", "thesis145", "icra81", "feelers169"] = "thesis144"
    """Layout of the observation: heights of 10 x 14 points (T table 3.1), the same and the number
    of surfaces around the robot (T 5.2.3), 11 x 7 (I sec. III), or 10 x 14 with a finer profile of
    the ground ahead and the margin of the conditions with the root moved (`Feelers`)."""
    outline_spacing: Annotated[float, Field(ge=0.0, le=1.0)] = 0.0
    """Largest distance of further points that the conditions read along the outline of the trunk
    and in the square under the root [m]: nothing that is thicker passes between them. 0: there are
    no such points, and the conditions read points up to 0.11 m apart."""
    height_low: float = LOWEST
    """Lower bound z_min to which heights are clipped [m], relative to the root."""
    height_high: float = HIGHEST
    """Upper bound z_max to which heights are clipped [m], relative to the root."""
    desired_speed: Positive = 0.1
    """Speed at which the root should move towards the goal, v_desired [m/s]."""
    goal_radius: Positive = 0.2
    """Distance within which the goal counts as reached [m] (T sec. 3.4.2)."""
    episode_steps: Count = 250
    """Length at which an episode is cut [steps]. The thesis has 800: most of that is standing at
    dead ends; the hard part, turning and stepping onto the transition, is in the first hundred."""
    near_share: Fraction = 0.5
    """Share of episodes that begin right before the crossing, where turning is hardest."""
    wander_share: Fraction = 0.2
    """Share of episodes that begin with a random goal, as all do once their link is crossed."""
    goal_steps: tuple[Count, Count] = (200, 800)
    """Range from which a goal's duration is drawn [steps]; a goal also ends when it is reached."""
    conditions: NamedConditions = STANDARD
    """Conditions that end an episode where they fail: `reachability` (R), `strict_reachability`
    (R*), `collision` (C), one `{surrogate: FILE}`, and MODULE:CLASS of the user's own, which
    --allow must repeat on the command line."""
    limits: MotionLimits = MotionLimits()
    guard: GuardConfig = GuardConfig()
    reward: RewardWeights = RewardWeights()

    @classmethod
    def suited(cls, stated: Mapping[str, Any]) -> dict[str, Any]:
        """Return the heights and the terrain that suit the robot."""
        robot = stated.get("robot", DEFAULT_ROBOT)
        return suited_to(robot) if isinstance(robot, str) else {}

    @classmethod
    def for_robot(cls, robot: str) -> Self:
        """Return the default configuration for a robot.

        Raises:
            InputError: there is no such robot, or its file does not describe it.
        """
        load_robot(robot)
        return cls(robot=robot, **suited_to(robot).get("env", {}))

    def signature(self) -> Signature:
        """Return the signature: the layout's observation; acceleration and turn rate as action."""
        layout = layout_named(self.observation)
        height_range = (self.height_low, self.height_high)
        mean, deviation = affine_scaling(layout, height_range, self.limits.max_speed)
        observation = Part(
            "observation",
            (layout.size,),
            mean=tuple(map(float, mean)),
            deviation=tuple(map(float, deviation)),
            mirror=Mirror(
                tuple(map(int, layout.mirror_permutation)), tuple(map(float, layout.mirror_sign))
            ),
        )
        turn = self.limits.max_turn_rate
        command = Normal(
            "command",
            (Ball(self.limits.max_acceleration), Interval(-turn, turn)),
            Mirror.of_signs(MIRROR_ACTION_SIGN.tolist()),
        )
        return Signature((observation,), (command,))

    def describe(self) -> dict[str, Any]:
        """Return how to assemble an exported policy's input, and how to apply its command."""
        from jaxleas.envs.steering.description import describe_steering

        return describe_steering(self)

    def pinned(self) -> Self:
        """Return the same task, with the absolute path and digest of each file that it names."""
        return self.model_copy(update={"conditions": pinned_conditions(self.conditions)})

    def under_standard_conditions(self) -> Self:
        """Return the same task under R* and C, the conditions under which policies are compared."""
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
