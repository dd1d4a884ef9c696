"""Population-based training: the worse take over from the better, and try other numbers.

Jaderberg et al., *Population Based Training of Neural Networks* (2017): exploit (truncation
selection) and explore (perturb or resample), between examinations.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Annotated, Any

import numpy as np
from pydantic import Field

from jaxleas.configuration.strict import Strict
from jaxleas.sweeps.config import Dimension

Values = dict[str, Any]


class EvolutionConfig(Strict):
    """How a population evolves."""

    every: Annotated[int, Field(ge=1)] = 2
    """Examinations between two rounds."""
    share: Annotated[float, Field(gt=0.0, le=0.5)] = 0.25
    """So much of the population, the worst by held-out success, takes over from as many best."""
    perturb: Annotated[float, Field(gt=0.0, le=1.0)] = 0.2
    """Each number then goes up or down by this part of its range, on the range's scale."""
    resample: Annotated[float, Field(ge=0.0, le=1.0)] = 0.25
    """Probability that a number is drawn anew instead."""


@dataclass(frozen=True)
class Succession:
    """One round's outcome for one member.

    Attributes:
        member: that it is about.
        parent: whose weights it goes on with: its own number if it keeps them.
        values: of the varied fields from now on.
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
    """Return who takes over from whom, and with which numbers.

    Args:
        config: how.
        space: ranges of the varied fields.
        scores: of the members, higher is better; NaN is worst. Of equals the first is better.
        values: of the varied fields, a member each.
        stream: of random numbers.
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
