"""The configuration of a population, and those of its members."""

from collections.abc import Collection
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Any, Self

import numpy as np
from pydantic import Field, model_validator

from jaxleas.configuration import Strict, load_config, present_name, require_field, with_values
from jaxleas.envs import TASKS
from jaxleas.sweeps.base import load_base
from jaxleas.sweeps.config import Dimension, Seed
from jaxleas.sweeps.evolution import EvolutionConfig, Values, draw_values
from jaxleas.sweeps.space import check_dimension
from jaxleas.training import RunConfig, swept_fields
from jaxleas.types import InputError


class PopulationConfig(Strict):
    """Several trainings in one compiled program."""

    config: str
    """Configuration that the members start from, relative to this file."""
    set: dict[str, Any] = Field(default_factory=dict)
    """Fields that are changed for all members, by dotted name."""
    seeds: Annotated[tuple[Seed, ...], Field(min_length=1)] = tuple(range(8))
    """Training seeds, one member each."""
    vary: dict[str, Dimension] = Field(default_factory=dict)
    """Fields that each member draws at random; only numbers that change no shape."""
    evolution: EvolutionConfig | None = None
    """Population-based training over the varied fields; none: members are independent."""
    seed: Seed = 0
    """Seed of the values drawn for the members, and of the evolution."""

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
    """The members of a population, and how it evolves.

    Attributes:
        configs: run configurations of the members.
        values: values of the varied fields, one mapping per member.
        space: ranges of the varied fields.
        evolution: configuration of the evolution; None: members are independent.
        seed: seed of the evolution.
        allow: user's own code that may be run, as MODULE:CLASS.
    """

    configs: tuple[RunConfig, ...]
    values: tuple[Values, ...]
    space: dict[str, Dimension] = field(default_factory=dict)
    evolution: EvolutionConfig | None = None
    seed: int = 0
    allow: tuple[str, ...] = ()

    def with_values(self, values: list[Values]) -> list[RunConfig]:
        """Return the members' configurations with other values of the varied fields."""
        pairs = zip(self.configs, values, strict=True)
        return [with_values(config, each, "evolution") for config, each in pairs]


def open_population(path: str | Path, allow: Collection[str] = ()) -> Members:
    """Read a population's file and the configuration it names.

    Args:
        path: path of the file.
        allow: user's own code that may be run, as MODULE:CLASS.

    Raises:
        InputError: the value is invalid; the message names the file, the key, and what would do.
    """
    path = Path(path)
    config = load_config(PopulationConfig, path)
    base = load_base(path, config.config, config.set, allow)
    _require_vectorised(base, path, allow)
    for name, dimension in config.vary.items():
        where = f"{path}: vary"
        require_field(type(base), name, where)
        if present_name(type(base), name) not in swept_fields(base.env):
            raise InputError(
                f"{where}.{name} is another program for every value; within one program may vary:"
                f" {', '.join(swept_fields(base.env))}"
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
    return Members(
        tuple(configs), tuple(values), config.vary, config.evolution, config.seed, tuple(allow)
    )


def _require_vectorised(base: RunConfig, path: Path, allow: Collection[str]) -> None:
    """Refuse a task that steps on the host: its members cannot share a compiled program."""
    if TASKS.find(base.env.task, allow).on_host:
        raise InputError(
            f"{path}: the task {base.env.task} steps on the host, one training at a time, and a"
            " population is one compiled program: sweep over its configuration with jaxleas sweep"
        )
    if base.begin:
        raise InputError(
            f"{path}: begin: members of a population begin untrained: leave it out, or sweep over"
            " the configuration with jaxleas sweep"
        )
