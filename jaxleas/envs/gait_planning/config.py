"""The configuration of gait planning: tables I, II and IV of D, with its values as defaults."""

import math
from typing import Annotated, Any, ClassVar, Literal, Self

from pydantic import Field, model_validator

from jaxleas.configuration import Count, NonNegative, Positive, Strict
from jaxleas.dynamics import LEAST_MARGIN
from jaxleas.envs import Signature, TaskConfig, WorldsConfig
from jaxleas.envs.gait_planning.quadruped import QuadrupedConfig
from jaxleas.terrain import FIELD_KINDS, FieldConfig


class ActionScales(Strict):
    """What an action of 1 means (D table I)."""

    turn: Positive = math.pi / 8
    """Turn of the base in a phase [rad]."""
    step: Positive = 0.3
    """Motion of the base in a phase, ahead and to the left [m]."""
    speed: Positive = 1.0
    """Velocity of the base at the end of a phase, ahead and to the left [m/s]."""
    foot: Positive = 0.3
    """Offset of a foot from its nominal place, ahead and to the left [m]."""
    middle_time: Positive = 1.0
    """Middle of the range of both times [s]."""
    time: Positive = 0.9
    """Half of the range of both times [s]."""

    @model_validator(mode="after")
    def _lasts(self) -> Self:
        if self.time >= self.middle_time:
            raise ValueError(
                f"time = {self.time:g} must be below middle_time = {self.middle_time:g}: phases"
                " last longer than 0 s"
            )
        return self


class GaitRewards(Strict):
    """Weights of the reward's terms (D table II, and r_T of table IV)."""

    progress: NonNegative = 25.0
    """w_p, on the way of the mean of all feet towards the goal [1/m]."""
    effort: NonNegative = 80.0
    """w_k, on the cubes of the feet's distances from their nominal places [1/m^3]."""
    stance: NonNegative = 0.01
    """w_c, on the numbers of phases since each foot was lifted."""
    failure: NonNegative = 1.0
    """-r_T, price of a transition that is refused."""
    alive: NonNegative = 0.0
    """Reward for every transition that is accepted. D has none: then a policy that is refused soon
    anyway does best to be refused at once, since standing costs."""
    change: NonNegative = 0.0
    """Reward for every accepted transition to another support. D has none: then standing on four
    feet, which is hardly ever refused, is all that a policy with `alive` learns."""


class Shares(Strict):
    """Relative frequencies of the kinds of fields."""

    flat: NonNegative = 1.0
    random_stairs: NonNegative = 1.0
    gaps: NonNegative = 1.0
    stones: NonNegative = 1.0
    stairs: NonNegative = 1.0
    temple: NonNegative = 1.0

    @model_validator(mode="after")
    def _some(self) -> Self:
        if not any(getattr(self, kind) for kind in FIELD_KINDS):
            raise ValueError("all shares are 0: give one above 0")
        return self


class GaitWorldsConfig(WorldsConfig):
    """The terrain on which gaits are planned."""

    arenas: Count = 600
    """Number of fields, drawn in bulk; each episode begins somewhere on one of them."""
    shares: Shares = Shares()
    field: FieldConfig = FieldConfig()


class GaitPlanningConfig(TaskConfig):
    """Gait planning as a Markov decision process over support phases (D sec. III-A)."""

    swept: ClassVar[tuple[str, ...]] = tuple(f"reward.{name}" for name in GaitRewards.model_fields)

    task: Literal["gait_planning"] = "gait_planning"  # type: ignore[assignment]
    robot: QuadrupedConfig = QuadrupedConfig()
    action: ActionScales = ActionScales()
    contact_code: Literal["five_way", "published"] = "five_way"
    """How an action names the feet in contact: one of five supports, each with numbers of its own;
    or three numbers whose signs are bits (D table I)."""
    placing: Literal["base_first", "feet_first"] = "base_first"
    """What an action places first: the base, and the feet about it (D table I); or the feet about
    the present base, and then the base about the mean of those in contact."""
    observation: Literal["light", "published"] = "light"
    """Heights that are seen: 138 around the feet, under the trunk and ahead, for a dense network;
    or a map of 32 x 32 (for `network.kind: maps`)."""
    action_gain: Annotated[float, Field(gt=0.0, le=4.0)] = 0.2
    """Gain of the head of real numbers: with 1, an untrained policy proposes one feasible
    transition in thirty, and learns little from the others."""
    least_margin: Annotated[float, Field(ge=0.0)] = LEAST_MARGIN
    """Margin of CROC from which on a transition is accepted [1]."""
    instants: Annotated[int, Field(ge=2, le=32)] = 4
    """Instants of each phase at which CROC is checked."""
    foot_clearance: NonNegative = 0.05
    """Distance of footholds from changes of height [m]."""
    snap: NonNegative = 0.0
    """Distance within which a proposed foothold that is not safe moves to the nearest safe cell
    [m]. D has 0: a policy must place each foot itself, to the centimetre."""
    edge_rise: Positive = 0.01
    """Change of height between neighbouring cells that counts [m]."""
    goal_radius: Positive = 0.5
    """Distance of the base within which a goal counts as reached [m] (D sec. IV-B)."""
    goal_distance: tuple[Positive, Positive] = (0.7, 4.0)
    """Range of the distance from start to goal in training [m]."""
    examined_distance: tuple[Positive, Positive] = (2.0, 5.0)
    """Range of the distance from start to goal in the examination [m]."""
    episode_steps: Count = 50
    """Length at which an episode is cut [phases] (D table IV)."""
    reward: GaitRewards = GaitRewards()

    def signature(self) -> Signature:
        """Return the signature of the observation and of the action."""
        from jaxleas.envs.gait_planning.signature import signature_of

        return signature_of(self)

    def describe(self) -> dict[str, Any]:
        """Return what an exported policy says of its input and its command."""
        from jaxleas.envs.gait_planning.signature import description_of

        return super().describe() | description_of(self)

    @model_validator(mode="after")
    def _ordered(self) -> Self:
        for name in ("goal_distance", "examined_distance"):
            low, high = getattr(self, name)
            if low > high:
                raise ValueError(f"{name} = [{low:g}, {high:g}] must be [least, most]")
        return self
