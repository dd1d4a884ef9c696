import numpy as np
import pytest

from jaxleas.geometry import Box, Polytope, clip_polygon


def inside(corners: np.ndarray, points: np.ndarray) -> np.ndarray:
    """Tell which points of the plane z = 0.3 x lie in a counter-clockwise polygon."""
    flat, ahead = corners[:, :2], np.roll(corners[:, :2], -1, axis=0)
    left = [
        (b[0] - a[0]) * (points[:, 1] - a[1]) - (b[1] - a[1]) * (points[:, 0] - a[0])
        for a, b in zip(flat, ahead, strict=True)
    ]
    return np.min(left, axis=0) >= 0.0


def polygon(seed: int) -> np.ndarray:
    rng = np.random.default_rng(seed)
    angle = np.sort(rng.uniform(0.0, 2 * np.pi, 7))
    flat = rng.uniform(-0.4, 0.4, 2) + np.column_stack([np.cos(angle), np.sin(angle)])
    return np.column_stack([flat, 0.3 * flat[:, 0]])


@pytest.mark.parametrize("seed", range(8))
def test_a_point_is_in_the_part_when_it_is_in_both(seed: int) -> None:
    rng = np.random.default_rng(100 + seed)
    polytope = Polytope.from_points(rng.normal(scale=0.5, size=(12, 3)))
    whole = polygon(seed)
    part = clip_polygon(whole, polytope)
    flat = rng.uniform(-1.4, 1.4, size=(20000, 2))
    points = np.column_stack([flat, 0.3 * flat[:, 0]])
    both = inside(whole, points) & polytope.contains(points)
    assert both.sum() > 100
    assert (inside(part, points) == both).all()
    np.testing.assert_allclose(part[:, 2], 0.3 * part[:, 0], atol=1e-12)


def test_what_is_wholly_inside_comes_back_itself_and_what_is_outside_is_gone() -> None:
    whole = polygon(3)
    assert clip_polygon(whole, Polytope.from_box(Box((-9, -9, -9), (9, 9, 9)))) is whole
    assert len(clip_polygon(whole, Polytope.from_box(Box((5, 5, -9), (9, 9, 9))))) == 0


def test_no_corner_is_listed_twice() -> None:
    square = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], float)
    corner = Polytope.from_box(Box((-1, -1, -1), (1 - 1e-8, 0.5, 1)))
    cut = Polytope.from_box(Box((-1, -1, -1), (0.5, 0.5, 1)))
    assert len(clip_polygon(square, cut)) == 4
    assert len(clip_polygon(square, corner)) == 4
    through = Polytope(np.array([[1.0, -1.0, 0.0]]) / 2**0.5, np.zeros(1))  # through two corners
    assert len(clip_polygon(square, through)) == 3
