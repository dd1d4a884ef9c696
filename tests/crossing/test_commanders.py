"""Commanders: goals in turn, another run-up where nothing is gained, and blind walks."""

import numpy as np
import pytest

from jaxleas.crossing import BlindCommander, PlanningCommander
from jaxleas.footsteps import FootstepPlan, Goal, PlannedFootstep, WalkingState
from jaxleas.types import InputError
from tests.footsteps.made import IDENTITY


def state(x=0.0, y=0.0, yaw=0.0, speed=0.0):
    still = np.zeros(3)
    velocity = np.array([speed, 0.0, 0.0])
    return WalkingState(np.array([x, y, 0.4]), yaw, velocity, 0.0, np.zeros((4, 3)), 0, still)


class Asked:
    """A planner that keeps the goals it is asked for, and finds no path."""

    def __init__(self):
        self.goals = []

    def plan(self, state, goal):
        self.goals.append(goal)
        return FootstepPlan("stand", (), np.inf, 0.0, 1)


def test_a_robot_that_gets_no_nearer_is_sent_back_and_then_on_again():
    planner, goal = Asked(), Goal(3.0, 0.0)
    commander = PlanningCommander(planner, [goal], seed=1)
    for _ in range(40):
        assert commander.decide(state(x=1.0)).intent == "no path"
    back = [index for index, each in enumerate(planner.goals) if each is not goal]
    assert back
    assert back[0] > 9  # it waits first
    assert len(back) < 30  # and tries again
    for index in back:
        assert 0.15 <= 1.0 - planner.goals[index].x <= 0.60


@pytest.mark.parametrize(("x", "y"), [(1.0, 3.0), (1.5, -3.0)])
def test_a_robot_that_walks_sideways_backs_off_sideways(x, y):
    planner, goal = Asked(), Goal(x, y)
    commander = PlanningCommander(planner, [goal], seed=1)
    for _ in range(20):
        commander.decide(state(x=1.0))
    back = [each for each in planner.goals if each is not goal]
    assert back
    assert all(each.x == pytest.approx(1.0) for each in back)
    assert all(0.15 <= -each.y * np.sign(y) <= 0.60 for each in back)


def test_a_robot_that_gains_ground_is_not_sent_back():
    planner, goal = Asked(), Goal(3.0, 0.0)
    commander = PlanningCommander(planner, [goal])
    for step in range(25):
        commander.decide(state(x=0.08 * step))
    assert all(each is goal for each in planner.goals)


def test_goals_are_walked_to_in_turn_and_the_last_one_needs_a_slow_robot():
    planner = Asked()
    goals = [Goal(1.0, 0.0, distance=0.15), Goal(2.0, 0.0, speed=0.2)]
    commander = PlanningCommander(planner, goals)
    numbers = [commander.decide(state(x=x, speed=0.5)).goal for x in (0.0, 0.9, 1.5, 2.0)]
    assert numbers == [0, 1, 1, 1]
    assert goals[1].is_met_by(state(x=2.02, speed=0.1))
    assert not goals[1].is_met_by(state(x=2.02, speed=0.5))


def test_a_blind_robot_goes_straight_at_its_goal():
    commander = BlindCommander(IDENTITY, [Goal(0.0, 2.0, 0.5)], share=0.5)
    decision = commander.decide(state(yaw=0.0))
    np.testing.assert_allclose(decision.command, [0.0, 0.4, 0.5])
    turned = commander.decide(state(yaw=np.pi / 2))
    np.testing.assert_allclose(turned.command, [0.4, 0.0, -0.8], atol=1e-9)
    arrived = commander.decide(state(x=0.01, y=2.0, yaw=0.5))
    assert arrived.intent == "arrived"
    assert not arrived.command.any()
    with pytest.raises(InputError, match=r"a blind walk at 1\.5 of the largest speed"):
        BlindCommander(IDENTITY, [Goal(1.0, 0.0)], 1.5)


class Straight:
    """A planner that has arrived once the robot is near enough, and else goes ahead."""

    def __init__(self):
        self.goals = []

    def plan(self, state, goal):
        self.goals.append(goal)
        if goal.is_met_by(state):
            return FootstepPlan("reached", (), 0.0, 0.0, 1)
        ahead = PlannedFootstep(0, np.array([0.3, 0.0, 0.0]), state.com[:2], 0.0, state.feet)
        return FootstepPlan("horizon", (ahead,), 1.0, 0.0, 1)


def test_a_robot_told_to_stop_is_left_alone_until_it_rests():
    planner, goal = Straight(), Goal(1.0, 0.0, speed=0.25)
    commander = PlanningCommander(planner, [goal])
    assert commander.decide(state(x=0.97, speed=0.2)).intent == "arrived"
    for x, speed in ((1.02, 0.12), (1.06, 0.1)):  # beside its goal, but not yet at rest
        assert commander.decide(state(x=x, speed=speed)).intent == "arrived"
    assert len(planner.goals) == 1


def test_a_robot_that_comes_to_rest_beside_its_goal_aims_that_far_before_it():
    planner, goal = Straight(), Goal(1.0, 0.0, speed=0.25)
    commander = PlanningCommander(planner, [goal])
    commander.decide(state(x=0.97, speed=0.2))
    assert commander.decide(state(x=1.07)).intent == "go"
    assert planner.goals[-1].x == pytest.approx(0.93)
    assert commander.decide(state(x=0.93, speed=0.1)).intent == "arrived"
    assert commander.decide(state(x=1.01)).intent == "arrived"  # at rest, at the goal itself
    asked = Straight()
    far = PlanningCommander(asked, [goal])
    far.decide(state(x=0.97, speed=0.2))
    far.decide(state(x=1.5))  # pushed aside: that is not how far a robot goes on
    assert asked.goals[-1].x == pytest.approx(0.9)
