"""Plans made easier to track: margins grow, feet and ends stay."""

import numpy as np

from jaxleas.gaits import eased, taken
from jaxleas.gaits.easing import ENOUGH
from jaxleas.gaits.tracked_programs import tracked_margins
from tests.controllers.tracks import one_step


def margins(plan):
    before, after = taken(plan.phases, slice(0, -1)), taken(plan.phases, slice(1, None))
    return tracked_margins(plan, before, after, plan.times).margin


def test_the_smallest_margin_grows_and_all_but_rests_between_the_ends_stays():
    plan = one_step()
    plan.phases.com[1, :2] = [0.04, -0.03]  # hardly inside the three feet
    found = eased(plan)
    before, after = margins(plan).min(), margins(found).min()
    assert after > before
    assert after >= min(ENOUGH, before + 0.02)
    np.testing.assert_array_equal(found.phases.com[[0, 2]], plan.phases.com[[0, 2]])
    np.testing.assert_array_equal(found.phases.com[:, 2], plan.phases.com[:, 2])
    np.testing.assert_array_equal(found.phases.feet, plan.phases.feet)
    np.testing.assert_array_equal(found.times, plan.times)


def test_margins_are_the_same_far_from_the_origin():
    plan = one_step()
    near = margins(plan)
    for each in (plan.phases.com, plan.phases.feet):
        each[..., :2] += np.float32([512.0, -1024.0])
    np.testing.assert_allclose(margins(plan), near, atol=1e-3)
