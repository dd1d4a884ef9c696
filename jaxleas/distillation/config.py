"""Configuration of a distillation: the planner, the rounds, and the work of each round."""

from collections.abc import Mapping
from typing import Annotated, Literal, Self

from pydantic import AfterValidator, Field, JsonValue, field_validator, model_validator

from jaxleas.configuration import Count, NonNegative, Positive, Seed, Strict, Whole
from jaxleas.contacts import DEFAULT_JUDGE, require_planner_name
from jaxleas.envs.steering import SteeringConfig, TerrainConfig
from jaxleas.evaluation import RECIPES
from jaxleas.surrogates import FitSettings
from jaxleas.training import RunConfig

SteeringRun = RunConfig[SteeringConfig, TerrainConfig]
Observation = Literal["thesis144", "thesis145", "icra81"]
RewardTerm = Literal["direction", "orientation", "turn", "acceleration", "alive", "failure"]


class CollectConfig(Strict):
    """Which guide paths the exact planner is asked about."""

    guides: Count = 12_000
    """Number of guide paths in the first round, when nothing is known."""
    later_guides: Count = 8_000
    """Number of guide paths in each later round."""
    parameters: dict[str, JsonValue] = Field(default_factory=dict)
    """Parameters of the planner that labels, where they differ from those of the judging one: a
    planner with less freedom fails sooner, and a policy that avoids its failures has a margin."""
    steps: Count = 150
    """Steps of a guide path: turning and stepping onto a transition happen in the first hundred."""
    disturbances: tuple[NonNegative, ...] = (0.0, 0.15, 0.3, 0.6)
    """Standard deviations of the disturbances added to the policy's actions, in units of their
    range; each applies to an equal share of the guide paths. The planner's limits show where the
    policy does not go by itself."""
    candidates: Count = 3
    """Guide paths walked per guide path judged, from the second round on; half of those judged are
    the ones whose verdict the surrogate is least sure of."""


class PracticeConfig(Strict):
    """How the policy continues to learn, with the surrogate ending its episodes."""

    steps: Count = 2_000_000
    """Environment steps per round."""
    steps_before: Whole = 0
    """Environment steps before the first round, without a surrogate: to adapt to another reward,
    speed or observation."""
    learning_rate: Positive = 2e-4
    final_learning_rate: NonNegative = 1e-5
    threshold: Annotated[float, Field(ge=0.0, lt=1.0)] = 0.0
    """The risk dial: 0 ends as many episodes as the planner would; more makes policies careful."""
    observation: Observation | None = None
    """Observation layout of the policy; its own by default. A layout that adds to the policy's own
    starts with weights of zero on the new values."""
    desired_speed: Positive | None = None
    """Speed towards the goal [m/s]; that of the policy's own training by default."""
    reward: dict[RewardTerm, NonNegative] = Field(default_factory=dict)
    """Weights of the reward that differ from those of the policy's own training (env.reward)."""
    terrain: TerrainConfig | None = None
    """Terrain of the guide paths to be labelled and of practice; that of the policy's own training
    by default."""


class FaithfulConfig(Strict):
    """Mode `faithful`: how walks and verdicts overlap."""

    robots: Count = 128
    """Number of robots that walk a whole episode at once, one wave."""
    ahead: Whole = 1
    """Waves that are walked while another is judged: 0 keeps the device waiting for the planner;
    more make the learned experience older."""


class JudgeConfig(Strict):
    """How a round's policy is judged by the exact planner, on held-out terrain."""

    suites: tuple[str, ...] = ("transitions", "hole", "wall")
    starts: Count = 100
    """Number of starts per cell."""

    @field_validator("suites")
    @classmethod
    def _cells_once(cls, suites: tuple[str, ...]) -> tuple[str, ...]:
        """Refuse unknown suites, and suites that share a cell, before hours of work."""
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
    """What ends episodes in practice: a surrogate of the planner, or the exact planner itself."""
    planner: Annotated[str, AfterValidator(require_planner_name)] = DEFAULT_JUDGE
    """Name of a planner, or MODULE:CLASS of a custom one, which the command line must also name."""
    parameters: dict[str, JsonValue] = Field(default_factory=dict)
    """Parameters of the planner; those not named have the planner's own defaults."""
    rounds: Count = 4
    """Greatest number of rounds; it ends earlier when the exact success stops rising."""
    patience: Count = 2
    """Number of rounds without a rise after which the distillation ends."""
    seed: Seed = 0
    """Seed of the guide paths and the fits."""
    run: SteeringRun = SteeringRun()
    """Run of the policy to begin with, where none is given, and base of every round's practice."""
    collect: CollectConfig = CollectConfig()
    fit: FitSettings = FitSettings()
    practice: PracticeConfig = PracticeConfig()
    faithful: FaithfulConfig = FaithfulConfig()
    judge: JudgeConfig = JudgeConfig()

    @classmethod
    def former_names(cls) -> Mapping[str, str]:
        """Return the former names of `run` fields that files may still use."""
        names = SteeringRun.former_names().items()
        return {f"run.{former}": f"run.{present}" for former, present in names}

    @property
    def labelling_parameters(self) -> dict[str, JsonValue]:
        """Return the parameters of the planner that labels."""
        return self.parameters | self.collect.parameters

    @model_validator(mode="after")
    def _one_planner_in_the_loop(self) -> Self:
        if self.mode == "faithful" and self.collect.parameters:
            raise ValueError(
                "collect.parameters are of a planner that labels, and in mode faithful nothing is"
                " labelled: leave them out, or give parameters"
            )
        return self
