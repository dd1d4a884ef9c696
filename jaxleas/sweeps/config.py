"""The configuration of a sweep: search space, objectives, number of trials."""

import json
from typing import Annotated, Any, Literal, Self

from pydantic import AfterValidator, Field, JsonValue, model_validator

from jaxleas.configuration import Count, Seed, Strict
from jaxleas.contacts import DEFAULT_JUDGE, require_built_in


class Dimension(Strict):
    """The possible values of one field of the run configuration: a range or choices."""

    low: float | None = None
    """Smallest value of a range; the field's type determines whether it holds whole numbers."""
    high: float | None = None
    """Largest value of a range."""
    log: bool = False
    """Draw the logarithm uniformly."""
    step: Annotated[float, Field(gt=0.0)] | None = None
    """Draw only low, low + step, low + 2 step, and so on."""
    choices: tuple[JsonValue, ...] | None = None
    """Values of which one is drawn."""
    only_when: dict[str, JsonValue] = Field(default_factory=dict)
    """Condition under which it is drawn: the fields named here, listed earlier in the space, have
    these values (or one of a list of values); otherwise it keeps the base configuration's value."""

    @property
    def ends(self) -> tuple[float, float]:
        """Smallest and largest value of a range."""
        if self.low is None or self.high is None:
            raise TypeError("choices have no ends")
        return self.low, self.high

    @model_validator(mode="after")
    def _one_kind(self) -> Self:
        ends = (self.low, self.high)
        if self.choices is None and None in ends:
            raise ValueError("give low and high, or choices")
        if self.choices is not None and (ends != (None, None) or self.step or self.log):
            raise ValueError("choices go without low, high, log and step")
        return self

    @model_validator(mode="after")
    def _possible(self) -> Self:
        if self.choices is not None:
            texts = [json.dumps(each) for each in self.choices]
            if not texts:
                raise ValueError("choices is empty; name at least one value")
            twice = next((each for each in texts if texts.count(each) > 1), None)
            if twice is not None:
                raise ValueError(f"choices names {twice} twice")
            return self
        low, high = self.ends
        if low > high:
            raise ValueError(f"low = {low:g} is above high = {high:g}")
        if low == high:
            raise ValueError(
                f"the range is empty: low and high are both {low:g}; a single value goes under set"
            )
        if self.log and low <= 0.0:
            raise ValueError(f"log needs numbers above 0, but low is {low:g}")
        if self.log and self.step is not None:
            raise ValueError("log and step do not go together")
        return self


class HeldOut(Strict):
    """Success of the best policy, the one that is kept, in the examination on held-out terrain."""

    measure: Literal["held_out"] = "held_out"

    @property
    def name(self) -> str:
        """Name in tables and files."""
        return "held_out"


class TimeToSuccess(Strict):
    """Time after which an examination first has a given success."""

    measure: Literal["steps_to_success", "seconds_to_success"]
    success: Annotated[float, Field(gt=0.0, le=1.0)] = 0.9

    @property
    def name(self) -> str:
        """Name in tables and files."""
        return f"{self.measure.partition('_')[0]}_to_{100 * self.success:g}%"


class Exact(Strict):
    """Success under an exact contact planner, mean over cells, on held-out suites."""

    measure: Literal["exact"]
    planner: Annotated[str, AfterValidator(require_built_in)] = DEFAULT_JUDGE
    parameters: dict[str, JsonValue] = Field(default_factory=dict)
    """Options of the planner; unnamed ones have the planner's own defaults."""
    suites: Annotated[tuple[str, ...], Field(min_length=1)] = ("transitions",)
    starts: Count = 50
    """Number of starts per cell."""

    @property
    def name(self) -> str:
        """Name in tables and files."""
        return f"exact_{self.planner}"


Objective = Annotated[HeldOut | TimeToSuccess | Exact, Field(discriminator="measure")]


class SweepConfig(Strict):
    """One sweep."""

    config: str
    """Configuration that trials start from, relative to the sweep's file."""
    set: dict[str, Any] = Field(default_factory=dict)
    """Fields that are changed in all trials, by dotted name."""
    space: dict[str, Dimension]
    """Fields that are searched, by dotted name."""
    objectives: tuple[Objective, ...] = (HeldOut(),)
    """Measures of a trial; for several, the best compromises are found."""
    trials: Count = 20
    seeds: tuple[Seed, ...] = (0,)
    """Training seeds of every trial, whose value is the mean over them."""
    sampler: Literal["tpe", "random"] = "tpe"
    pruner: Literal["none", "median", "hyperband"] = "none"
    """Method that ends a trial early, by the learning curve of its first seed; the other seeds are
    then not run."""
    startup_trials: Count = 5
    """Number of trials before which the median pruner ends none."""
    parallel: Count = 1
    """Number of trainings at the same time."""
    vectorised: bool | Literal["auto"] = "auto"
    """Train many trials in one compiled program: possible if the space has only numbers that
    change no shape. `auto`: do so if it is possible, no pruner is set and no objective needs
    trainings that run alone."""
    members: Count = 8
    """Number of trainings in one such program."""
    seed: Seed = 0
    """Seed of the sampler."""

    @model_validator(mode="after")
    def _nothing_empty(self) -> Self:
        for name in ("space", "objectives", "seeds"):
            if not getattr(self, name):
                raise ValueError(f"{name} is empty: name at least one")
        return self

    @model_validator(mode="after")
    def _seeds_differ(self) -> Self:
        twice = next((each for each in self.seeds if self.seeds.count(each) > 1), None)
        if twice is not None:
            raise ValueError(f"seeds names {twice} twice: the same training again proves nothing")
        return self

    @model_validator(mode="after")
    def _objectives_differ(self) -> Self:
        names = [each.name for each in self.objectives]
        twice = next((each for each in names if names.count(each) > 1), None)
        if twice is not None:
            raise ValueError(f"objectives measures {twice} twice")
        if self.pruner != "none" and len(names) > 1:
            raise ValueError(
                f"pruner = {self.pruner} needs a single objective to compare curves by; there are"
                f" {len(names)}: {', '.join(names)}"
            )
        return self
