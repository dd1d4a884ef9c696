"""The lowest swing that clears the steps ahead is chosen, and only where it may take over."""

from dataclasses import replace

import numpy as np
import pytest

from jaxleas.footsteps import FootstepPlan, Goal, PlannedFootstep, SwingChoice, WalkingState
from tests.footsteps.made import IDENTITY

GOAL = Goal(3.0, 0.0)
RADIUS = IDENTITY.foot_radius


class Fixed:
    """A planner of a controller with some swing height, which answers as it was told."""

    def __init__(self, swing, heights=(), refused=0, status="horizon"):
        self.controller = replace(IDENTITY, name=f"swing {swing}", swing_height=swing)
        self.asked = []
        steps, feet = [], np.zeros((4, 3))
        for number, height in enumerate(heights):
            feet = feet.copy()
            feet[list(IDENTITY.pairs[number % 2]), 2] = height
            steps.append(PlannedFootstep(number % 2, np.ones(3), np.zeros(2), 0.0, feet))
        counts = {"step height": refused}
        self._plan = FootstepPlan(
            status, tuple(steps), 1.0, 0.0, 1, counts, controller=self.controller.name
        )

    def plan(self, state, goal):
        self.asked.append(state)
        return self._plan


def state(pair=0, command=0.3, heights=(0.0, 0.0, 0.0, 0.0)):
    feet = np.zeros((4, 3))
    feet[:, 2] = np.array(heights) + RADIUS
    velocity = np.array([command, 0.0, 0.0])
    return WalkingState(np.zeros(3), 0.0, velocity, 0.0, feet, pair, velocity)


def chosen(planners, *states):
    choice = SwingChoice(planners, first=0)
    return [choice.plan(each, GOAL).controller for each in states]


def test_on_level_ground_the_lowest_walks_and_the_others_are_not_asked():
    low, high = Fixed(0.06, [0.0, 0.0]), Fixed(0.10, [0.0, 0.0])
    assert chosen([high, low], state()) == ["swing 0.06"]
    assert not high.asked


@pytest.mark.parametrize(("step", "expected"), [(0.05, 0.06), (0.07, 0.08), (0.09, 0.1)])
def test_the_lowest_that_clears_the_next_steps_takes_over(step, expected):
    planners = [
        Fixed(0.06, [0.0, 0.0], refused=3),
        Fixed(0.08, [0.0, min(step, 0.08)]),
        Fixed(0.10, [0.0, step]),
    ]
    assert chosen(planners, state()) == [f"swing {expected}"]


def test_a_high_step_far_ahead_does_not_count_yet():
    far = [0.0] * 6 + [0.09]
    assert chosen([Fixed(0.06, [0.0], 1), Fixed(0.10, far)], state()) == ["swing 0.06"]


def test_another_takes_over_only_where_its_first_pair_swings_next_or_at_rest():
    low, high = Fixed(0.06, [0.0], refused=1), Fixed(0.10, [0.0, 0.09])
    assert chosen([low, high], state(pair=1), state(pair=0)) == ["swing 0.06", "swing 0.1"]
    assert chosen([low, high], state(pair=1, command=0.0)) == ["swing 0.1"]
    assert high.asked[-1].pair == 0  # it begins with its own first pair


def test_the_high_one_walks_where_the_low_one_has_no_plan_and_stays_while_astride():
    stuck, high = Fixed(0.06, status="stand"), Fixed(0.10, [0.0])
    assert chosen([stuck, high], state()) == ["swing 0.1"]
    low, high = Fixed(0.06, [0.0]), Fixed(0.10, [0.08])
    choice = SwingChoice([low, high], first=0)
    low._plan = replace(low._plan, refused={"step height": 1})
    assert choice.plan(state(), GOAL).controller == "swing 0.1"
    low._plan = replace(low._plan, refused={})
    astride = state(heights=(0.08, 0.08, 0.0, 0.0))
    assert choice.plan(astride, GOAL).controller == "swing 0.1"
    assert choice.plan(state(), GOAL).controller == "swing 0.06"
