import numpy as np
import pytest

from jaxleas.terrain.polygons import (
    box_faces,
    convexity_deviation,
    is_vertical,
    planarity_deviation,
    polygon_area_vector,
    require_convex_polygon,
)
from jaxleas.types import InputError


@pytest.mark.parametrize("seed", range(20))
def test_deviations_do_not_depend_on_the_frame(seed, random_polygon):
    rng = np.random.default_rng(seed)
    vertices = random_polygon(rng) + rng.normal(scale=0.05, size=(1, 3))
    vertices[0, 2] += 0.1
    rotation = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    rotation *= np.sign(np.linalg.det(rotation))
    moved = vertices @ rotation.T + rng.normal(size=3)
    assert planarity_deviation(moved) == pytest.approx(planarity_deviation(vertices), abs=1e-9)
    assert convexity_deviation(moved) == pytest.approx(convexity_deviation(vertices), abs=1e-9)


@pytest.mark.parametrize("seed", range(20))
def test_random_convex_polygons_pass_and_reversed_ones_do_not(seed, random_polygon):
    vertices = random_polygon(np.random.default_rng(seed))
    require_convex_polygon(vertices, "p", wall=False)
    with pytest.raises(InputError, match="clockwise"):
        require_convex_polygon(vertices[::-1], "p", wall=False)


def test_area_vector_of_a_unit_square_points_up():
    square = np.array([[0.0, 0, 5], [1, 0, 5], [1, 1, 5], [0, 1, 5]])
    np.testing.assert_allclose(polygon_area_vector(square), [0.0, 0.0, 1.0])


def test_a_dent_is_measured_in_metres():
    dented = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0.5, 0.75, 0], [0, 1, 0]])
    assert convexity_deviation(dented) == pytest.approx(0.5 / np.hypot(0.5, 0.25) * 0.5, rel=1e-6)


@pytest.mark.parametrize(
    ("vertices", "problem"),
    [
        ([[0, 0, 0], [1, 0, 0]], "at least 3"),
        ([[0, 0, 0], [1, 0, 0], [1, 1, np.nan]], "finite"),
        ([[0, 0, 0], [1, 0, 0], [1, 1, 0], [1, 0, 0]], "repeats a vertex"),
        ([[0, 0, 0], [1, 0, 0], [2, 0, 0]], "degenerate"),
        ([[0, 0, 0], [1, 0, 0], [1, 1, 0.2], [0, 1, 0]], r"not planar: .* 0\.0\d+ m"),
        ([[0, 0, 0], [1, 0, 0], [0.2, 0.2, 0], [0, 1, 0]], r"not convex: .* 0\.\d+ m"),
        ([[0, 0, 0], [1, 0, 0], [1, 0, 1], [0, 0, 1]], "vertical"),
        # a pentagram turns left at every corner
        ([[np.cos(4 * np.pi * k / 5), np.sin(4 * np.pi * k / 5), 0] for k in range(5)], "convex"),
    ],
)
def test_refusals_say_what_is_wrong(vertices, problem):
    with pytest.raises(InputError, match=problem):
        require_convex_polygon(np.array(vertices, dtype=float), "surface 'a'", wall=False)


def test_box_faces_are_closed_and_wound_outwards():
    corners = np.array([[0.0, 0], [2, 0], [2, 1], [0, 1]])
    faces = box_faces(corners, 0.5, 2.0)
    for vertices in faces.values():
        require_convex_polygon(vertices, "face", wall=True)
    centre = np.array([1.0, 0.5, 1.25])
    for name, vertices in faces.items():
        assert polygon_area_vector(vertices) @ (vertices.mean(axis=0) - centre) > 0.0
        assert is_vertical(vertices) == name.startswith("side")
    # the faces of a closed body sum to its missing bottom
    total = sum(polygon_area_vector(vertices) for vertices in faces.values())
    np.testing.assert_allclose(total, [0.0, 0.0, 2.0], atol=1e-12)
