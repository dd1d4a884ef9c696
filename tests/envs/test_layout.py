import numpy as np
import pytest

from jaxleas.envs.steering.layout import FEELERS169, ICRA81, THESIS144, layout_named
from jaxleas.types import InputError

LAYOUTS = [ICRA81, THESIS144, FEELERS169]


def test_sizes_are_the_published_ones():
    assert ICRA81.size == 81  # I table I
    assert THESIS144.size == 10 * 14 + 4  # T table 3.1


def test_reach_is_the_published_one():
    """About 110 cm ahead, 50 cm behind, 60 cm a side (T sec. 3.2.2), to the cells' far edges."""
    x, y = THESIS144.points_in_root.T
    assert x.max() + 0.15 / 2 == pytest.approx(1.10, abs=0.06)
    assert x.min() - 0.17 / 2 == pytest.approx(-0.50, abs=0.02)
    assert y.max() + 0.09 / 2 == pytest.approx(0.60, abs=0.035)
    assert sum(row > 0 for row in THESIS144.rows) == 7
    assert sum(row > 0 for row in ICRA81.rows) == 9


@pytest.mark.parametrize("layout", LAYOUTS, ids=lambda layout: layout.name)
def test_no_stripe_at_the_root_is_unseen(layout):
    assert np.diff(layout.rows).max() <= 0.2
    assert np.diff(layout.columns).max() <= 0.15 + 1e-9


@pytest.mark.parametrize("layout", LAYOUTS, ids=lambda layout: layout.name)
def test_mirroring_swaps_the_points_left_and_right(layout):
    points = layout.points_in_root
    order = layout.mirror_permutation[4 : 4 + len(points)] - 4
    np.testing.assert_array_equal(points[order], points * [1, -1])


@pytest.mark.parametrize("layout", LAYOUTS, ids=lambda layout: layout.name)
def test_mirroring_twice_changes_nothing(layout):
    permutation = layout.mirror_permutation
    np.testing.assert_array_equal(permutation[permutation], np.arange(layout.size))
    np.testing.assert_array_equal(layout.mirror_sign**2, 1)
    assert set(np.flatnonzero(layout.mirror_sign < 0)) == {1, 3}


def test_an_unknown_layout_is_refused_with_the_known_ones():
    with pytest.raises(InputError, match="thesis144"):
        layout_named("thesis81")
