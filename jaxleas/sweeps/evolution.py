"""Population-based training: worse members copy better ones, and try other values.

Jaderberg et al., *Population Based Training of Neural Networks* (2017): exploit (truncation
selection) and explore (perturb or resample), between examinations.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Annotated, Any

import numpy as np
from pydantic import Field

from jaxleas.configuration import Strict
from jaxleas.sweeps.config import Dimension

Values = dict[str, Any]


class EvolutionConfig(Strict):
    """Configuration of a population's evolution."""

    every: Annotated[int, Field(ge=1)] = 2
    """Number of examinations between two rounds."""
    share: Annotated[float, Field(gt=0.0, le=0.5)] = 0.25
    """Share of the population, the worst by held-out success, that copies an equal share of the
    best."""
    perturb: Annotated[float, Field(gt=0.0, le=1.0)] = 0.2
    """Part of its range by which each value then moves up or down, on the range's scale."""
    resample: Annotated[float, Field(ge=0.0, le=1.0)] = 0.25
    """Probability that a value is drawn anew instead."""


@dataclass(frozen=True)
class Succession:
    """The result of one round for one member.

    Attributes:
        member: number of the member.
        parent: number of the member whose weights it continues with; its own if it keeps them.
        values: values of the varied fields from now on.
    """

    member: int
    parent: int
    values: Values


def draw_values(space: Mapping[str, Dimension], stream: np.random.Generator) -> Values:
    """Return values drawn from a space without conditions or whole numbers."""
    return {name: draw_one(each, stream) for name, each in space.items()}


def evolve(
    config: EvolutionConfig,
    space: Mapping[str, Dimension],
    scores: Sequence[float],
    values: Sequence[Values],
    stream: np.random.Generator,
) -> list[Succession]:
    """Return, for each member, whose weights it continues with, and with which values.

    Args:
        config: configuration of the evolution.
        space: ranges of the varied fields.
        scores: scores of the members; higher is better, NaN is worst, and the first of equals is
            better.
        values: values of the varied fields, one mapping per member.
        stream: generator of random numbers.
    """
    order = sorted(range(len(scores)), key=lambda i: (-_finite(scores[i]), i))
    count = min(max(1, round(config.share * len(order))), len(order) // 2)
    best, worst = order[:count], order[len(order) - count :]
    successions = []
    for member, own in enumerate(values):
        parent, new = member, own
        if member in worst:
            parent = best[int(stream.integers(len(best)))]
            new = {
                name: draw_one(space[name], stream)
                if stream.random() < config.resample
                else perturbed(space[name], value, config.perturb, stream)
                for name, value in values[parent].items()
            }
        successions.append(Succession(member, parent, dict(new)))
    return successions


def draw_one(dimension: Dimension, stream: np.random.Generator) -> Any:
    """Return one value of a range or choices."""
    if dimension.choices is not None:
        return dimension.choices[int(stream.integers(len(dimension.choices)))]
    return _at(dimension, float(stream.random()))


def perturbed(dimension: Dimension, value: Any, part: float, stream: np.random.Generator) -> Any:
    """Return a value moved up or down by a part of its range, or to the neighbouring choice."""
    up = bool(stream.integers(2))
    if dimension.choices is not None:
        index = dimension.choices.index(value) + (1 if up else -1)
        return dimension.choices[min(max(index, 0), len(dimension.choices) - 1)]
    low, high = dimension.ends
    if dimension.log:
        place = np.log(value / low) / np.log(high / low)
    else:
        place = (value - low) / (high - low)
    return _at(dimension, float(np.clip(place + (part if up else -part), 0.0, 1.0)))


def _at(dimension: Dimension, place: float) -> float:
    """Return the value at `place` in [0, 1] of a range, on its scale and grid."""
    low, high = dimension.ends
    if dimension.log:
        return float(np.clip(low * (high / low) ** place, low, high))
    value = low + place * (high - low)
    if dimension.step is not None:
        value = low + round((value - low) / dimension.step) * dimension.step
        value = value if value <= high else value - dimension.step
    return float(value)


def _finite(score: float) -> float:
    return score if np.isfinite(score) else -np.inf
