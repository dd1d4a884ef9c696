"""Time to find the surfaces of 10 x 10 m of terrain in cells of 2 cm."""

import time
from dataclasses import replace

import numpy as np

from benchmarks.maps.plans import CELL, NOISE
from jaxleas.terrain import GeneratorConfig, HeightMap, cropped, find_surfaces, generate_arena
from jaxleas.terrain import rasterise as map_of

SEED = 2_000_000
SIDE = 10.0  # [m]


def arena() -> HeightMap:
    """Return an arena of 25 tiles with white noise, 500 x 500 cells."""
    exact = map_of(generate_arena(GeneratorConfig(), SEED).scene, CELL)
    exact = cropped("arena", exact, (0.0, SIDE, 0.0, SIDE))
    noise = NOISE * np.random.default_rng(SEED).normal(size=exact.shape)
    return replace(exact, heights=(exact.heights + noise).astype(np.float32))


def planes_seconds(repeats: int) -> list[float]:
    """Return the processor time of each run [s]: other work on the machine hardly counts."""
    height_map, seconds = arena(), []
    find_surfaces(height_map)  # loads SciPy
    for _ in range(repeats):
        begin = time.process_time()
        find_surfaces(height_map)
        seconds.append(time.process_time() - begin)
    return seconds
