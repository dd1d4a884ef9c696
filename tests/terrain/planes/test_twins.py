"""What is fast against slow twins in NumPy that share no code with it."""

import numpy as np
import pytest
from scipy.spatial import ConvexHull

from jaxleas.terrain.planes.assigning import KERNEL, LOYAL, NO_PLANE, OUTLIER, assign
from jaxleas.terrain.planes.convex_parts import area, convex_parts
from jaxleas.terrain.planes.plane import Plane, fitted
from jaxleas.terrain.planes.polygons import parts_of
from jaxleas.terrain.planes.region import Growth, Region
from jaxleas.terrain.planes.rings import rings
from jaxleas.terrain.planes.windows import fit_windows


@pytest.mark.parametrize("size", [3, 5])
def test_windows_are_least_squares_planes(size):
    rng = np.random.default_rng(size)
    known = rng.random((14, 17)) < 0.8
    heights = np.where(known, rng.normal(size=known.shape), 0.0)
    found = fit_windows(heights, known, size)
    half = size // 2
    for row, column in np.ndindex(known.shape):
        cells = [
            (r, c)
            for r in range(row - half, row + half + 1)
            for c in range(column - half, column + half + 1)
            if 0 <= r < 14 and 0 <= c < 17 and known[r, c]
        ]
        if len(cells) < max(6, 0.5 * size**2):
            assert np.isnan(found.deviation[row, column])
            continue
        at = np.array([(1.0, r - row, c - column) for r, c in cells])
        z = np.array([heights[each] for each in cells])
        plane, _, rank, _ = np.linalg.lstsq(at, z, rcond=None)
        if rank < 3:
            continue
        mine = found.height, found.along_rows, found.along_columns
        np.testing.assert_allclose([each[row, column] for each in mine], plane, atol=1e-9)
        rest = ((at @ plane - z) ** 2).sum() / max(len(z) - 3, 1)
        assert found.deviation[row, column] == pytest.approx(np.sqrt(rest), abs=1e-9)


def test_a_plane_fits_its_cells_as_least_squares_do():
    rng = np.random.default_rng(0)
    cells = rng.random((9, 12)) < 0.5
    heights = rng.normal(size=cells.shape)
    plane = fitted(heights, cells, (slice(20, 29), slice(7, 19)))
    row, column = np.nonzero(cells)
    at = np.stack([np.ones(len(row)), row + 20, column + 7], axis=1)
    wanted = np.linalg.lstsq(at, heights[cells], rcond=None)[0]
    np.testing.assert_allclose(plane, wanted, atol=1e-9)


def test_cells_go_to_the_plane_that_fits_around_them():
    rng = np.random.default_rng(3)
    x = np.arange(24.0)
    heights = np.tile(np.where(x < 11, 0.0, 0.05), (16, 1)) + 0.01 * rng.normal(size=(16, 24))
    known = rng.random(heights.shape) < 0.9
    heights = np.where(known, heights, 0.0)
    ground = Growth(heights, known, 0.01, 0.02, 10)
    box = (slice(0, 16), slice(0, 24))
    cores = [np.zeros((16, 24), bool) for _ in range(2)]
    cores[0][3:13, 3:8], cores[1][3:13, 14:20] = True, True
    planes = [Plane(0.0, 0.0, 0.0), Plane(0.05, 0.0, 0.0)]
    regions = [Region(plane, box, core) for plane, core in zip(planes, cores, strict=True)]
    owner = assign(ground, regions, 5)
    wanted = slow_owner(ground, regions, 5)
    inner = np.s_[3:13, 4:20]  # beyond, and where cells are no plane's own, others decide
    same = owner[inner] == wanted[inner]
    assert same.mean() > 0.98
    off = np.abs(heights - np.where(wanted == 2, 0.05, 0.0)) > 0.03
    assert (same | off[inner]).all()  # only outliers are settled afterwards


def slow_owner(ground: Growth, regions: list[Region], smooth: int) -> np.ndarray:
    rows, columns = ground.known.shape
    owner = np.zeros((rows, columns), int)
    for row, column in np.argwhere(ground.known):
        best = np.inf
        for number, region in enumerate(regions, start=1):
            core = np.argwhere(region.cells)
            if np.abs(core - [row, column]).max(axis=1).min() > smooth // 2 + 2:
                continue
            close, wide = [], []
            for r in range(row - smooth // 2, row + smooth // 2 + 1):
                for c in range(column - smooth // 2, column + smooth // 2 + 1):
                    if not (0 <= r < rows and 0 <= c < columns and ground.known[r, c]):
                        continue
                    gap = (ground.heights[r, c] - region.plane.height) / ground.noise
                    square = min(gap**2, OUTLIER**2)
                    wide.append(square)
                    if abs(r - row) <= 1 and abs(c - column) <= 1:
                        close.append((KERNEL[r - row + 1] * KERNEL[c - column + 1], square))
            weights, squares = np.array(close).T
            misfit = np.mean(wide) + (0.0 if region.cells[row, column] else LOYAL)
            if misfit < best and weights @ squares / weights.sum() < NO_PLANE:
                best, owner[row, column] = misfit, number
    return owner


def test_rings_run_around_their_cells():
    rng = np.random.default_rng(1)
    for _ in range(20):
        cells = rng.random((7, 9)) < 0.6
        found = rings(cells)
        assert sum(area(ring.astype(float)) for ring in found) == cells.sum()
        for ring in found:
            step = np.abs(np.roll(ring, -1, axis=0) - ring)
            assert (step.sum(axis=1) == 1).all()


def test_convex_parts_fill_a_polygon_around_its_holes():
    rng = np.random.default_rng(2)
    for corners in (5, 9, 14):
        angle = np.sort(rng.uniform(0.0, 2.0 * np.pi, corners))
        radius = rng.uniform(4.0, 20.0, corners)
        outer = np.stack([radius * np.cos(angle), radius * np.sin(angle)], axis=1)
        if area(outer) <= 0.0 or np.diff(angle).max() > 2.5:
            continue
        hole = np.array([[-0.5, -0.5], [-0.5, 0.5], [0.5, 0.5], [0.5, -0.5]])
        for holes in ([], [hole]):
            whole = area(outer) + sum(map(area, holes))
            parts = convex_parts(outer, holes)
            filled = sum(map(area, parts))
            assert 0.85 * whole <= filled <= whole * (1.0 + 1e-9)
            for part in parts:
                assert area(part) == pytest.approx(ConvexHull(part).volume)


def square(low: float, high: float, turn: int) -> np.ndarray:
    return np.array([[low, low], [high, low], [high, high], [low, high]])[::turn]


def test_an_outline_that_its_hole_crosses_is_no_outline():
    outer, inside, across = square(0.0, 300.0, 1), square(10.0, 30.0, -1), square(290.0, 310.0, -1)
    parts = parts_of([outer, inside])
    assert parts is not None
    assert sum(map(area, parts)) == pytest.approx(300.0**2 - 20.0**2)
    assert parts_of([outer, across]) is None
