"""Kinds of fields, and their height maps from a seed."""

from typing import Literal, get_args

import numpy as np

from jaxleas.terrain.fields.config import FieldConfig
from jaxleas.terrain.fields.sections import Draw, flight, gap, platform, stones
from jaxleas.terrain.height_map import HeightMap

FieldKind = Literal["flat", "random_stairs", "gaps", "stones", "stairs", "temple"]
FIELD_KINDS: tuple[FieldKind, ...] = get_args(FieldKind)
SECTIONS: dict[str, tuple[Draw, ...]] = {
    "flat": (platform,),
    "gaps": (gap,),
    "stones": (stones,),
    "stairs": (flight,),
    "temple": (gap, stones, flight),
}
"""Sections of each kind, between which platforms lie; Temple-Ascent has them all (D sec. IV-A)."""


def draw_field(kind: FieldKind, config: FieldConfig, seed: int) -> HeightMap:
    """Return a field; the same for the same seed.

    Args:
        kind: kind of the field.
        config: its sizes.
        seed: seed of all that is random.
    """
    generator = np.random.default_rng([seed, FIELD_KINDS.index(kind)])
    heights = (
        _plates(config, generator) if kind == "random_stairs" else _row(kind, config, generator)
    )
    if generator.random() < 0.5:  # sections have a direction
        heights = heights[:, ::-1]
    middle = 0.5 * config.resolution
    return HeightMap(np.ascontiguousarray(heights, np.float32), config.resolution, (middle, middle))


def _row(kind: str, config: FieldConfig, generator: np.random.Generator) -> np.ndarray:
    """Return platforms with sections between them; the last platform fills what is left."""
    columns, kinds = config.shape[1], SECTIONS[kind]
    parts = [platform(config, 0.0, generator)]
    used = parts[0].heights.shape[1]
    while True:
        draw = kinds[int(generator.integers(len(kinds)))]
        obstacle = draw(config, parts[-1].end, generator)
        rest = platform(config, obstacle.end, generator)
        used += obstacle.heights.shape[1] + rest.heights.shape[1]
        if used > columns:
            break
        parts += [obstacle, rest]
    heights = np.concatenate([part.heights for part in parts], axis=1)[:, :columns]
    left = columns - heights.shape[1]
    return np.pad(heights, ((0, 0), (0, left)), constant_values=parts[-1].end)


def _plates(config: FieldConfig, generator: np.random.Generator) -> np.ndarray:
    """Return square plates on a slope along a diagonal: Random-Stairs (D sec. IV-A)."""
    side = config.cells(config.plate)
    rows, columns = config.shape
    i, j = np.indices((rows // side + 2, columns // side + 2))
    across = 1 if generator.random() < 0.5 else -1
    slope = config.plate_slope * (across * i + j)
    heights = slope + generator.uniform(-config.plate_rise, config.plate_rise, i.shape)
    whole = np.kron(heights, np.ones((side, side)))
    top, left = generator.integers(side, size=2)
    return (whole[top : top + rows, left : left + columns] - whole[top, left]).astype(np.float32)
