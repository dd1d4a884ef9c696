"""The map that a robot has of its terrain: true, or noisy and in the wrong place."""

from dataclasses import dataclass, replace

import numpy as np

from jaxleas.terrain import HeightMap
from jaxleas.types import InputError


@dataclass(frozen=True)
class MapErrors:
    """How the robot's map differs from the terrain.

    Attributes:
        noise: standard deviation of the noise that is added to the height of each cell [m].
        shift: distance by which the map is shifted, in a random direction [m].
        seed: seed of the random draws.
    """

    noise: float = 0.0
    shift: float = 0.0
    seed: int = 0

    def __post_init__(self) -> None:
        if not (0.0 <= self.noise < np.inf and 0.0 <= self.shift < np.inf and self.seed >= 0):
            raise InputError(
                f"map noise {self.noise:g} m, shift {self.shift:g} m and seed {self.seed}: give"
                " finite numbers that are not negative"
            )

    def of(self, height_map: HeightMap) -> HeightMap:
        """Return the map that the robot has."""
        rng = np.random.default_rng(self.seed)
        angle = rng.uniform(0.0, 2.0 * np.pi)
        added = self.noise * rng.standard_normal(height_map.shape)
        x, y = height_map.origin
        return replace(
            height_map,
            heights=(height_map.heights + added).astype(np.float32),
            origin=(x + self.shift * np.cos(angle), y + self.shift * np.sin(angle)),
        )
