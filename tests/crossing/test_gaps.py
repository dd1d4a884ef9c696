"""From a stand in front of a gap of 16 cm, a plan of eight footsteps crosses it."""

from dataclasses import replace

import numpy as np
import pytest

from jaxleas.crossing import WalkSettings, make_course
from jaxleas.footsteps import (
    FootCostMap,
    FootstepPlanner,
    WalkingState,
    buffer_of,
    shipped_model,
)
from jaxleas.terrain import rasterise

HIP, SIDE = 0.37, 0.2
"""Distance of the feet from the middle of a standing robot: ahead and behind, aside [m]."""


def test_states_in_front_of_a_gap_do_not_crowd_out_those_that_cross_it():
    """The course's second gap; of the 64 states that promise most alone, none crosses it."""
    pytest.importorskip("mujoco")
    from jaxleas.controllers import find_controller
    from jaxleas.physics import load_body

    course = make_course("gaps_16cm")
    model = shipped_model(find_controller("trot", load_body("anymal_b")).identity)
    costs = FootCostMap.of(rasterise(course.scene, 0.01, 0.5), buffer_of(model))
    begin = course.scene.surfaces["block_0"][:, 0].max()
    end = course.scene.surfaces["block_1"][:, 0].min()
    assert end - begin == pytest.approx(0.16)

    x, still = begin - 0.06 - HIP, np.zeros(3)
    feet = np.array([[x + ahead, side, 0.0] for ahead in (HIP, -HIP) for side in (SIDE, -SIDE)])
    state = WalkingState(np.array([x, 0.0, 0.44]), 0.0, still, 0.0, feet, 1, still)
    search = replace(WalkSettings().search, doubt=0.0, jump=1.0)
    plan = FootstepPlanner(model, costs, search).plan(state, course.goals[0])
    assert len(plan.footsteps) == 8
    assert plan.footsteps[-1].feet[:, 0].min() > end
    for each in plan.footsteps:
        assert not np.any((begin < each.feet[:, 0]) & (each.feet[:, 0] < end))
