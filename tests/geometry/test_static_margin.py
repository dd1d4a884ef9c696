"""The distance inside the polygon of the feet, against half planes written out."""

import numpy as np
import pytest
from scipy.spatial import ConvexHull

from jaxleas.envs.gait_planning import STANDING
from jaxleas.geometry import distance_inside

NOMINAL = np.array([[0.34, 0.2], [0.34, -0.2], [-0.34, 0.2], [-0.34, -0.2]])


def by_hull(point, feet):
    """Return the distance by the half planes of the convex hull."""
    return -(ConvexHull(feet).equations @ np.append(point, 1.0)).max()


@pytest.mark.parametrize("support", range(len(STANDING)))
def test_it_is_the_distance_to_the_hull_of_the_feet_in_contact(support):
    generator = np.random.default_rng(support)
    for _ in range(50):
        feet = NOMINAL + generator.uniform(-0.1, 0.1, (4, 2))
        point = generator.uniform(-0.4, 0.4, 2)
        stands = STANDING[support]
        found = distance_inside(point, feet, stands)
        assert found == pytest.approx(by_hull(point, feet[stands]), abs=1e-6)


def test_it_broadcasts():
    found = distance_inside(np.zeros((3, 1, 2)), NOMINAL, STANDING)
    assert found.shape == (3, 5)
    assert found[:, 0] == pytest.approx(0.2)
    assert np.allclose(found[:, 1:], 0.0, atol=1e-6)
