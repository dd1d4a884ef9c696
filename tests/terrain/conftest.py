"""Random polygons and scenes for the terrain tests."""

import numpy as np
import pytest
from scipy.spatial import ConvexHull

from jaxleas.terrain.scene import Scene


def _random_polygon(rng: np.random.Generator, steepest: float = 0.5) -> np.ndarray:
    """Return a convex polygon, counter-clockwise from above, on a tilted plane [m]."""
    points = rng.uniform(-0.8, 0.8, size=(int(rng.integers(3, 9)), 2))
    corners = points[ConvexHull(points).vertices] + rng.uniform(-1.5, 1.5, size=2)
    slope = rng.uniform(-steepest, steepest, size=2)
    return np.column_stack([corners, corners @ slope + rng.uniform(-1.0, 1.0)])


@pytest.fixture
def random_polygon():
    """A function: random generator -> polygon."""
    return _random_polygon


@pytest.fixture
def random_scene():
    """A function: seed -> scene of four surfaces and four obstacles."""

    def make(seed: int) -> Scene:
        rng = np.random.default_rng(seed)
        return Scene(
            {f"s{index}": _random_polygon(rng) for index in range(4)},
            {f"o{index}": _random_polygon(rng) for index in range(4)},
        )

    return make
