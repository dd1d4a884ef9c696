"""Height maps whose surfaces are known."""

from dataclasses import replace

import numpy as np
import pytest

from jaxleas.terrain import HeightMap

CELL = 0.02


def map_of(heights: np.ndarray, cell: float = CELL) -> HeightMap:
    return HeightMap(np.asarray(heights, np.float32), cell, (0.5 * cell, 0.5 * cell))


def places(rows: int, columns: int, cell: float = CELL) -> tuple[np.ndarray, np.ndarray]:
    """Return x and y of the centres of cells, from the lower left corner of the map [m]."""
    y, x = np.meshgrid(np.arange(rows) + 0.5, np.arange(columns) + 0.5, indexing="ij")
    return x * cell, y * cell


def noisy(height_map: HeightMap, seed: int = 0, deviation: float = 0.01) -> HeightMap:
    noise = deviation * np.random.default_rng(seed).normal(size=height_map.shape)
    return replace(height_map, heights=(height_map.heights + noise).astype(np.float32))


def stairs(angle: float = 0.0) -> tuple[HeightMap, float, list[tuple[float, float, float]]]:
    """Return a map of stairs, its rise per tread, and begin, end and height of each tread.

    Treads of 0.24 to 0.36 m run along y turned by an angle [rad]; the map is 2.4 x 1.2 m.
    """
    x, y = places(60, 120)
    along = np.cos(angle) * (x - 1.2) + np.sin(angle) * (y - 0.6) + 1.2
    edges = np.array([-9.0, 0.4, 0.64, 0.9, 1.2, 1.56, 1.8, 9.0])
    number = np.searchsorted(edges, along) - 1
    treads = [(edges[k], edges[k + 1], 0.12 * k) for k in range(len(edges) - 1)]
    return map_of(0.12 * number), 0.12, treads


@pytest.fixture
def polygon_samples():
    """A function: polygon -> points of a grid of 1 cm in it, with their heights on it [m]."""

    def sample(polygon: np.ndarray, step: float = 0.01) -> np.ndarray:
        low, high = polygon[:, :2].min(axis=0), polygon[:, :2].max(axis=0)
        grid = np.stack(np.meshgrid(*map(np.arange, low, high, [step] * 2)), -1).reshape(-1, 2)
        edge = np.roll(polygon, -1, axis=0)[:, :2] - polygon[:, :2]
        rest = grid[:, None] - polygon[:, :2]
        inside = (edge[:, 0] * rest[..., 1] - edge[:, 1] * rest[..., 0] >= 0.0).all(axis=1)
        ones = np.ones((len(polygon), 1))
        plane = np.linalg.lstsq(np.hstack([polygon[:, :2], ones]), polygon[:, 2], rcond=None)[0]
        found = grid[inside]
        return np.column_stack([found, found @ plane[:2] + plane[2]])

    return sample
