"""The exact test against another way to decide: clip the polygon and see if anything is left."""

import numpy as np
import pytest

from jaxleas.geometry import Box, Polytope, pack_polygons, polygons_meet_polytope
from jaxleas.types import InputError

UNIT = Polytope.from_box(Box((0.0, 0.0, 0.0), (1.0, 1.0, 1.0)))


def clip_leaves_something(polygon, polytope):
    """Sutherland-Hodgman: cut the polygon with one face after the other."""
    for normal, offset in zip(polytope.normals, polytope.offsets, strict=True):
        kept = []
        for here, there in zip(polygon, np.roll(polygon, -1, axis=0), strict=True):
            slack_here, slack_there = offset - normal @ here, offset - normal @ there
            if slack_here >= 0:
                kept.append(here)
            if slack_here * slack_there < 0:
                kept.append(here + slack_here / (slack_here - slack_there) * (there - here))
        if not kept:
            return False
        polygon = np.array(kept)
    return True


def random_polygons(rng, count):
    """Convex, planar, of three to seven vertices, tilted any way."""
    for _ in range(count):
        angles = np.sort(rng.uniform(0, 2 * np.pi, rng.integers(3, 8)))
        size, turn = rng.uniform(0.05, 3.0), np.linalg.qr(rng.normal(size=(3, 3)))[0]
        flat = np.stack([np.cos(angles), np.sin(angles), 0 * angles], axis=-1) * size
        yield flat @ turn.T + rng.normal(size=3) * 1.2


@pytest.mark.parametrize("seed", range(3))
def test_it_agrees_with_clipping(seed):
    rng = np.random.default_rng(seed)
    polytope = Polytope.from_points(rng.normal(size=(30, 3)) * 0.6)
    polygons = list(random_polygons(rng, 500))
    meets = polygons_meet_polytope(pack_polygons(polygons), polytope)
    clipped = [clip_leaves_something(polygon, polytope) for polygon in polygons]
    np.testing.assert_array_equal(meets, clipped)
    assert 50 < meets.sum() < 450


def test_a_polytope_that_pierces_the_middle_of_a_large_polygon_meets_it():
    floor = np.array([[-9.0, -9, 0.5], [9, -9, 0.5], [9, 9, 0.5], [-9, 9, 0.5]])
    assert polygons_meet_polytope(floor[None], UNIT).all()


@pytest.mark.parametrize("axis", [0, 1, 2])
@pytest.mark.parametrize(("gap", "meets"), [(0.0, True), (-0.001, True), (0.001, False)])
def test_touching_meets_and_a_millimetre_apart_does_not(axis, gap, meets):
    others = [other for other in range(3) if other != axis]
    polygon = np.zeros((4, 3))
    polygon[:, others] = [[-9, -9], [9, -9], [9, 9], [-9, 9]]
    polygon[:, axis] = 1.0 + gap
    assert polygons_meet_polytope(polygon[None], UNIT)[0] == meets
    # and edge on edge, corner on corner
    small = np.array([[1.0, 1.0, 1.0], [2.0, 1.0, 1.0], [1.0, 2.0, 1.5]])
    small[:, axis] += gap
    assert polygons_meet_polytope(small[None], UNIT)[0] == meets


def test_moving_both_changes_nothing():
    rng = np.random.default_rng(7)
    points, polygons = rng.normal(size=(25, 3)), pack_polygons(random_polygons(rng, 300))
    turn, shift = np.linalg.qr(rng.normal(size=(3, 3)))[0], rng.normal(size=3)
    before = polygons_meet_polytope(polygons, Polytope.from_points(points))
    after = polygons_meet_polytope(
        polygons @ turn.T + shift, Polytope.from_points(points @ turn.T + shift)
    )
    np.testing.assert_array_equal(before, after)


def test_padding_and_winding_change_nothing():
    rng = np.random.default_rng(8)
    polygons = list(random_polygons(rng, 300))
    alone = [polygons_meet_polytope(polygon[None], UNIT)[0] for polygon in polygons]
    reversed_ = pack_polygons([polygon[::-1] for polygon in polygons])
    np.testing.assert_array_equal(polygons_meet_polytope(pack_polygons(polygons), UNIT), alone)
    np.testing.assert_array_equal(polygons_meet_polytope(reversed_, UNIT), alone)


def test_no_polygons_and_no_vertices():
    assert polygons_meet_polytope(pack_polygons([]), UNIT).shape == (0,)
    with pytest.raises(InputError, match="polygon 1"):
        pack_polygons([np.zeros((3, 3)), np.zeros((2, 3))])
