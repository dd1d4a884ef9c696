"""A robot that missed its goal when it stopped aims as far to the other side of it."""

import numpy as np
import pytest

from jaxleas.crossing.stop import MOST, Stop
from jaxleas.footsteps import Goal, WalkingState

GOAL = Goal(2.0, 1.0, 0.3)


def at_rest(x, y, yaw):
    still = np.zeros(3)
    return WalkingState(np.array([x, y, 0.4]), yaw, still, 0.0, np.zeros((4, 3)), 0, still)


@pytest.mark.parametrize("missed", [(0.06, -0.02, 0.0), (0.0, 0.0, -0.15), (-0.04, 0.05, 0.1)])
def test_it_aims_as_far_to_the_other_side(missed):
    stop = Stop()
    assert stop.aim_of(at_rest(1.0, 1.0, 0.3), GOAL) is GOAL
    stop.begin()
    rest = np.array([GOAL.x, GOAL.y, GOAL.yaw]) + missed
    aim = stop.aim_of(at_rest(*rest), GOAL)
    assert not stop.is_taken
    assert [aim.x, aim.y, aim.yaw] == pytest.approx([2.0, 1.0, 0.3] - np.array(missed))


def test_what_is_allowed_for_adds_up_to_a_limit():
    stop = Stop()
    aim = stop.aim_of(at_rest(1.0, 1.0, 0.3), GOAL)
    for _ in range(5):
        stop.begin()
        aim = stop.aim_of(at_rest(GOAL.x + 0.06, GOAL.y, GOAL.yaw + 0.12), GOAL)
    assert GOAL.x - aim.x == pytest.approx(MOST[0])
    assert GOAL.yaw - aim.yaw == pytest.approx(MOST[2])


def test_a_robot_that_rests_at_its_goal_stays():
    stop = Stop()
    stop.aim_of(at_rest(1.0, 1.0, 0.3), GOAL)
    stop.begin()
    assert stop.aim_of(at_rest(2.01, 1.0, 0.33), GOAL) is GOAL
    assert stop.is_taken
