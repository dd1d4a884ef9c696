"""What a population is told, and its members' configurations."""

from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Any, Self

import numpy as np
from pydantic import Field, model_validator

from jaxleas.configuration.loading import load_config
from jaxleas.configuration.strict import Strict
from jaxleas.configuration.values import require_field, with_values
from jaxleas.sweeps.border import check_dimension
from jaxleas.sweeps.config import Dimension, Seed
from jaxleas.sweeps.evolution import EvolutionConfig, Values, draw_values
from jaxleas.training.config import RunConfig
from jaxleas.training.ppo_params import SWEPT_FIELDS
from jaxleas.types.errors import InputError


class PopulationConfig(Strict):
    """Several trainings in one compiled program."""

    config: str
    """Configuration that the members start from, relative to this file."""
    set: dict[str, Any] = Field(default_factory=dict)
    """Fields that are changed for all members, by dotted name."""
    seeds: Annotated[tuple[Seed, ...], Field(min_length=1)] = tuple(range(8))
    """Training seeds: one member each."""
    vary: dict[str, Dimension] = Field(default_factory=dict)
    """Fields that each member draws at random; only numbers that change no shape."""
    evolution: EvolutionConfig | None = None
    """Population-based training over the varied fields; none: members never meet."""
    seed: Seed = 0
    """Of what is drawn for the members, and of the evolution."""

    @model_validator(mode="after")
    def _members_differ(self) -> Self:
        twice = next((each for each in self.seeds if self.seeds.count(each) > 1), None)
        if twice is not None and not self.vary:
            raise ValueError(f"seeds names {twice} twice, and nothing varies: the same training")
        if self.evolution is not None and not self.vary:
            raise ValueError("evolution needs numbers to try: name them under vary")
        if self.evolution is not None and len(self.seeds) < 2:
            raise ValueError("evolution needs at least two members: give more seeds")
        return self


@dataclass(frozen=True)
class Members:
    """Who is in a population, and how it evolves.

    Attributes:
        configs: of the members.
        values: of the varied fields, a member each.
        space: of the varied fields.
        evolution: None: members never meet.
        seed: of the evolution.
    """

    configs: tuple[RunConfig, ...]
    values: tuple[Values, ...]
    space: dict[str, Dimension] = field(default_factory=dict)
    evolution: EvolutionConfig | None = None
    seed: int = 0

    def with_values(self, values: list[Values]) -> list[RunConfig]:
        """Return the members' configurations with other values of the varied fields."""
        pairs = zip(self.configs, values, strict=True)
        return [with_values(config, each, "evolution") for config, each in pairs]


def open_population(path: str | Path) -> Members:
    """Read a population's file and the configuration it names.

    Raises:
        InputError: one sentence that names the file, the key, and what would do.
    """
    path = Path(path)
    config = load_config(PopulationConfig, path)
    base = load_config(RunConfig, path.parent / config.config)
    for name in config.set:
        require_field(RunConfig, name, f"{path}: set")
    base = with_values(base, config.set, f"{path}: set")
    for name, dimension in config.vary.items():
        where = f"{path}: vary"
        require_field(RunConfig, name, where)
        if name not in SWEPT_FIELDS:
            raise InputError(
                f"{where}.{name} is another program for every value; within one program may vary:"
                f" {', '.join(SWEPT_FIELDS)}"
            )
        if dimension.only_when:
            raise InputError(f"{where}.{name}.only_when: members vary in the same fields")
        check_dimension(name, dimension, base, where)
    values = [
        draw_values(config.vary, np.random.default_rng((config.seed, member)))
        for member in range(len(config.seeds))
    ]
    configs = [
        with_values(base, {**each, "seed": seed}, str(path))
        for each, seed in zip(values, config.seeds, strict=True)
    ]
    return Members(tuple(configs), tuple(values), config.vary, config.evolution, config.seed)
