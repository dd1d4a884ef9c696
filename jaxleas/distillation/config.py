"""What a distillation is told: which planner, how many rounds, and what is done in each."""

from collections.abc import Mapping
from typing import Annotated, Literal, Self

from pydantic import AfterValidator, Field, JsonValue, field_validator, model_validator

from jaxleas.configuration.bounds import Count, NonNegative, Positive, Seed, Whole
from jaxleas.configuration.strict import Strict
from jaxleas.contacts.registry import DEFAULT_JUDGE, require_planner_name
from jaxleas.envs.steering.config import SteeringConfig, TerrainConfig
from jaxleas.evaluation.recipes import RECIPES
from jaxleas.surrogates.settings import FitSettings
from jaxleas.training.config import RunConfig

SteeringRun = RunConfig[SteeringConfig, TerrainConfig]
Observation = Literal["thesis144", "thesis145", "icra81"]
RewardTerm = Literal["direction", "orientation", "turn", "acceleration", "alive", "failure"]


class CollectConfig(Strict):
    """Which guide paths the exact planner is asked about."""

    guides: Count = 12_000
    """In the first round, when nothing is known."""
    later_guides: Count = 8_000
    """In each round after it."""
    parameters: dict[str, JsonValue] = Field(default_factory=dict)
    """Of the planner that labels, where they differ from those of the planner that judges: one with
    less freedom fails sooner, and a policy that keeps clear of its failures keeps a margin."""
    steps: Count = 150
    """Of a guide path: turning and setting foot on a transition happen in the first hundred."""
    disturbances: tuple[NonNegative, ...] = (0.0, 0.15, 0.3, 0.6)
    """Standard deviations of what is added to the policy's actions, in units of their range; one
    guide path in so many each. The planner's limits show where the policy does not go of itself."""
    candidates: Count = 3
    """From the second round on, so many times as many guide paths are walked as are judged; half of
    those judged are the ones whose verdict the surrogate is least sure of."""


class PracticeConfig(Strict):
    """How the policy goes on learning, with the surrogate ending its episodes."""

    steps: Count = 2_000_000
    """Environment steps a round."""
    steps_before: Whole = 0
    """Environment steps before the first round, without surrogate: to get used to another reward,
    speed or observation."""
    learning_rate: Positive = 2e-4
    final_learning_rate: NonNegative = 1e-5
    threshold: Annotated[float, Field(ge=0.0, lt=1.0)] = 0.0
    """The risk dial: 0 ends as many episodes as the planner would, more makes policies careful."""
    observation: Observation | None = None
    """Layout that the policy sees by; its own by default. One that adds to the policy's own starts
    with weights of zero on what is new."""
    desired_speed: Positive | None = None
    """Speed towards the goal [m/s]; that of the policy's own training by default."""
    reward: dict[RewardTerm, NonNegative] = Field(default_factory=dict)
    """Weights of the reward that differ from those of the policy's own training (env.reward)."""
    terrain: TerrainConfig | None = None
    """That guide paths to be labelled and practice walk on; that of the policy's own training by
    default."""


class FaithfulConfig(Strict):
    """Mode `faithful`: how walks and verdicts overlap."""

    robots: Count = 128
    """That walk a whole episode at once, a wave."""
    ahead: Whole = 1
    """Waves that are walked while another is judged: 0 keeps the device waiting for the planner,
    more make what is learned from older."""


class JudgeConfig(Strict):
    """How a round's policy is judged by the exact planner, on held-out terrain."""

    suites: tuple[str, ...] = ("transitions", "hole", "wall")
    starts: Count = 100
    """A cell."""

    @field_validator("suites")
    @classmethod
    def _cells_once(cls, suites: tuple[str, ...]) -> tuple[str, ...]:
        """Refuse a suite that there is not, and suites that share a cell, before hours of work."""
        found: dict[tuple[str, float, float, float], str] = {}
        for name in suites:
            if name not in RECIPES:
                raise ValueError(f"no suite is called {name!r}; there are {', '.join(RECIPES)}")
            for row in RECIPES[name].rows:
                key = row.name, row.yaw, row.yaw_spread, row.speed
                if key in found:
                    raise ValueError(
                        f"{row.name} at {row.yaw:g} deg is in {found[key]} and in {name}, and"
                        " rounds are compared cell by cell: name one of these suites, once"
                    )
                found[key] = name
        return suites


class DistillationConfig(Strict):
    """One distillation: a policy and a surrogate, refined in turn against one exact planner."""

    mode: Literal["surrogate", "faithful"] = "surrogate"
    """Who ends episodes in practice: a surrogate of the planner, or the exact planner itself."""
    planner: Annotated[str, AfterValidator(require_planner_name)] = DEFAULT_JUDGE
    """Name of a planner, or MODULE:CLASS of one's own, which the command line must name, too."""
    parameters: dict[str, JsonValue] = Field(default_factory=dict)
    """Of the planner; what is not named has the planner's own default."""
    rounds: Count = 4
    """At most; it ends earlier when the exact success stops rising."""
    patience: Count = 2
    """Rounds without a rise after which it ends."""
    seed: Seed = 0
    """Of the guide paths and the fits."""
    run: SteeringRun = SteeringRun()
    """Of the policy to begin with, where none is given, and the base of every round's practice."""
    collect: CollectConfig = CollectConfig()
    fit: FitSettings = FitSettings()
    practice: PracticeConfig = PracticeConfig()
    faithful: FaithfulConfig = FaithfulConfig()
    judge: JudgeConfig = JudgeConfig()

    @classmethod
    def former_names(cls) -> Mapping[str, str]:
        """Return the fields of `run` that its files may still call otherwise."""
        names = SteeringRun.former_names().items()
        return {f"run.{former}": f"run.{present}" for former, present in names}

    @property
    def labelling_parameters(self) -> dict[str, JsonValue]:
        """Of the planner that labels."""
        return self.parameters | self.collect.parameters

    @model_validator(mode="after")
    def _one_planner_in_the_loop(self) -> Self:
        if self.mode == "faithful" and self.collect.parameters:
            raise ValueError(
                "collect.parameters are of a planner that labels, and in mode faithful nothing is"
                " labelled: leave them out, or give parameters"
            )
        return self
