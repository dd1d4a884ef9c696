"""Sections of a field: each draws one obstacle over some columns, from a height to a height."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from jaxtyping import Float32

from jaxleas.terrain.fields.config import FieldConfig

STEPS = (2, 4)
"""Numbers of steps of a flight: the least and the most."""


class Section(NamedTuple):
    """Part of a field.

    Attributes:
        heights: heights [row = y, column = x] [m]; NaN where there is no ground.
        end: height of the ground that follows [m].
    """

    heights: Float32[np.ndarray, "rows columns"]
    end: float


Draw = Callable[[FieldConfig, float, np.random.Generator], Section]
"""A kind of section: (sizes, height where it begins [m], generator) -> section."""


def platform(config: FieldConfig, begin: float, generator: np.random.Generator) -> Section:
    """Return level ground."""
    columns = config.cells(generator.uniform(*config.platform))
    return Section(_level(config, columns, begin), begin)


def gap(config: FieldConfig, begin: float, generator: np.random.Generator) -> Section:
    """Return a gap without ground, over the whole width."""
    columns = config.cells(generator.uniform(*config.gap))
    return Section(_level(config, columns, np.nan), begin)


def flight(config: FieldConfig, begin: float, generator: np.random.Generator) -> Section:
    """Return steps up or down, all of one size."""
    riser, tread = generator.uniform(*config.riser), generator.uniform(*config.tread)
    count = int(generator.integers(STEPS[0], STEPS[1] + 1))
    rise = riser if generator.random() < 0.5 else -riser
    heights = begin + rise * np.arange(1, count + 1)
    columns = np.repeat(heights, config.cells(tread)).astype(np.float32)
    return Section(np.tile(columns, (config.shape[0], 1)), float(heights[-1]))


def stones(config: FieldConfig, begin: float, generator: np.random.Generator) -> Section:
    """Return square stones over an abyss, in rows; each lies a little higher or lower."""
    side = config.cells(generator.uniform(*config.stone))
    apart = config.cells(generator.uniform(*config.stone_gap))
    rows, pitch = config.shape[0], side + apart
    along = max(1, config.cells(generator.uniform(*config.stones)) // pitch)
    heights = _level(config, along * pitch + apart, np.nan)
    across = -(-rows // pitch) + 1
    rise = generator.uniform(-config.stone_rise, config.stone_rise, (across, along))
    first = -int(generator.integers(pitch))  # where the first stone begins, outside or inside
    for i in range(across):
        top = max(0, first + i * pitch)
        for j in range(along):
            left = apart + j * pitch
            here = heights[top : max(0, first + i * pitch + side), left : left + side]
            here[:] = begin + rise[i, j]
    return Section(heights, begin)


def _level(config: FieldConfig, columns: int, height: float) -> np.ndarray:
    return np.full((config.shape[0], columns), height, np.float32)
