import numpy as np
import pytest

from jaxleas.geometry import Box, Polytope
from jaxleas.types import InputError


@pytest.fixture
def cloud():
    return np.random.default_rng(0).normal(size=(60, 3)) * np.array([1.0, 0.5, 0.3])


@pytest.fixture
def hull(cloud):
    return Polytope.from_points(cloud)


def test_a_hull_contains_its_points_and_their_mixtures(cloud, hull):
    assert hull.contains(cloud, 1e-9).all()
    weights = np.random.default_rng(1).dirichlet(np.ones(len(cloud)), size=200)
    assert hull.contains(weights @ cloud).all()


def test_a_hull_leaves_out_what_is_beyond_it(cloud, hull):
    assert not hull.contains(cloud.mean(axis=0) + 50 * (cloud - cloud.mean(axis=0))).any()


def test_faces_of_one_plane_are_merged():
    corners = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], dtype=float)
    assert len(Polytope.from_points(corners).offsets) == 6


def test_the_vertices_of_a_hull_hull_to_it_again(hull):
    again = Polytope.from_points(hull.vertices)
    points = np.random.default_rng(2).normal(size=(5000, 3))
    np.testing.assert_array_equal(hull.contains(points), again.contains(points))


def test_edges_and_vertices_obey_eulers_formula(hull):
    assert len(hull.vertices) - len(hull.edges) + len(hull.offsets) == 2


def test_the_z_interval_is_where_membership_changes(hull):
    points = np.random.default_rng(3).uniform(-2, 2, size=(300, 2))
    low, high = hull.z_interval(points)
    hit = np.isfinite(low)
    assert hit.any()
    assert not hit.all()
    for z, inside in ((low + 1e-6, True), (high - 1e-6, True), (low - 1e-6, False)):
        over = np.column_stack([points, z])[hit]
        assert (hull.contains(over, 0.0) == inside).mean() > 0.999
    heights = np.linspace(-2, 2, 401)
    for x, y in points[~hit]:
        column = np.column_stack([np.full_like(heights, x), np.full_like(heights, y), heights])
        assert not hull.contains(column).any()


def test_upright_faces_bound_the_z_interval():
    box = Polytope.from_box(Box((0.0, 0.0, -1.0), (1.0, 2.0, 3.0)))
    low, high = box.z_interval(np.array([[0.5, 1.0], [1.0, 2.0], [1.001, 1.0]]))
    np.testing.assert_array_equal(low, [-1.0, -1.0, np.nan])
    np.testing.assert_array_equal(high, [3.0, 3.0, np.nan])


def test_mirroring_swaps_left_and_right(hull):
    points = np.random.default_rng(4).normal(size=(2000, 3))
    mirrored = points * np.array([1.0, -1.0, 1.0])
    np.testing.assert_array_equal(hull.contains(points), hull.mirrored().contains(mirrored))


def test_a_cut_keeps_what_both_hold(hull):
    points = np.random.default_rng(5).normal(size=(2000, 3)) * 0.5
    cut = hull.cut(np.array([[1.0, 0.0, 0.0]]), np.array([0.1]))
    np.testing.assert_array_equal(
        cut.contains(points, 0.0), hull.contains(points, 0.0) & (points[:, 0] <= 0.1)
    )


def test_bounds_touch_the_outermost_points(cloud, hull):
    np.testing.assert_allclose(hull.bounds.low, cloud.min(axis=0), atol=1e-9)
    np.testing.assert_allclose(hull.bounds.high, cloud.max(axis=0), atol=1e-9)


@pytest.mark.parametrize(
    "points",
    [np.zeros((10, 3)), np.eye(3), np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]])],
)
def test_points_without_volume_are_refused(points):
    with pytest.raises(InputError, match="volume"):
        Polytope.from_points(points)


def test_empty_and_unbounded_polytopes_have_no_corners():
    with pytest.raises(InputError, match="empty"):
        _ = Polytope(np.array([[1.0, 0, 0], [-1.0, 0, 0]]), np.array([-1.0, -1.0])).vertices
    with pytest.raises(InputError, match="unbounded"):
        _ = Polytope(np.array([[0, 0, 1.0], [0, 0, -1.0]]), np.array([1.0, 1.0])).vertices


def test_ill_shaped_and_not_finite_polytopes_are_refused():
    with pytest.raises(InputError, match="normal"):
        Polytope(np.eye(3), np.ones(2))
    with pytest.raises(InputError, match="finite"):
        Polytope(np.eye(3), np.array([1.0, 1.0, np.nan]))
