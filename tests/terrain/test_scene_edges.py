"""Edges of a scene's polygons, against heights looked at all around."""

import numpy as np

from jaxleas.terrain import Scene, SceneEdges, ground_height


def rectangle(x_min, x_max, y_min, y_max, height=0.0):
    flat = [[x_min, y_min], [x_max, y_min], [x_max, y_max], [x_min, y_max]]
    return np.column_stack([flat, np.full(4, height)])


STEPS = Scene(
    {
        "low": rectangle(-2.0, 1.0, -1.0, 1.0),
        "high": rectangle(1.0, 3.0, -1.0, 1.0, 0.05),
        "level": rectangle(3.01, 4.0, -1.0, 1.0, 0.05),
        "almost level": rectangle(4.0, 5.0, -1.0, 1.0, 0.06),
    }
)


def nearest_by_sampling(scene, place, reach=0.08, spacing=0.002):
    """Return the distance to the nearest point whose height differs by more than 2 cm."""
    steps = np.arange(-reach, reach + spacing, spacing)
    around = np.stack(np.meshgrid(steps, steps), axis=-1).reshape(-1, 2)
    here = ground_height(scene, place[None])[0]
    differs = ~(np.abs(ground_height(scene, place + around) - here) <= 0.02)
    return np.hypot(*around[differs].T).min(initial=np.inf)


def test_a_riser_and_the_border_are_edges_from_both_sides():
    edges = SceneEdges.of(STEPS)
    places = np.array([[0.9, 0.0], [1.03, 0.2], [0.0, 0.98], [-1.96, 0.0], [2.0, 0.0]])
    np.testing.assert_allclose(edges.distance(places), [0.1, 0.03, 0.02, 0.04, 1.0], atol=2e-4)


def test_cracks_and_small_rises_are_none():
    far = SceneEdges.of(STEPS).distance(np.array([[3.0, 0.0], [4.0, 0.0], [3.5, 0.0]]))
    assert (far > 0.99).all()


def test_distances_are_those_to_other_heights():
    edges, rng = SceneEdges.of(STEPS), np.random.default_rng(0)
    for _ in range(40):
        place = rng.uniform((0.93, -0.99), (1.07, 0.99))
        sampled = nearest_by_sampling(STEPS, place)
        if np.isfinite(sampled):
            assert abs(edges.distance(place[None])[0] - sampled) < 0.004


def test_heights_are_those_of_the_highest_polygon():
    stacked = Scene({"ground": rectangle(-1, 1, -1, 1), "block": rectangle(0, 1, -1, 1, 0.2)})
    heights = ground_height(stacked, np.array([[-0.5, 0.0], [0.5, 0.0], [2.0, 0.0]]))
    np.testing.assert_allclose(heights, [0.0, 0.2, np.nan])


def test_tilted_ground_has_its_heights():
    ramp = Scene({"ramp": np.array([[0, 0, 0], [2, 0, 0.5], [2, 1, 0.5], [0, 1, 0]], float)})
    np.testing.assert_allclose(ground_height(ramp, np.array([[1.0, 0.5]])), [0.25])
