"""Roadmaps find the way round a trench, say when there is none, and keep to their budget."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from jaxleas.guide.roadmaps import Budget, Places
from jaxleas.guide.roadmaps.connections import Connector
from jaxleas.guide.roadmaps.ledger import Ledger, Question, key_of
from jaxleas.guide.roadmaps.walked import part_towards, passages
from jaxleas.guide.starts import start_motion
from jaxleas.types import GuidePath, InputError
from tests.guide.roadmaps.worlds import ENV, kino_navigator, trench_map
from tests.guide.twin import Twin

pytest.importorskip("ompl")
START, GOAL = (-1.5, -1.5), (1.5, -1.5)
TWIN = Twin(SimpleNamespace(config=ENV.config), ENV.robot, trench_map())


def navigate(navigator, goal=GOAL, connections=400, seed=1):
    start = start_motion(navigator.connector.places, START, goal, None)
    return navigator.navigate(start, np.array(goal), Budget(120.0, connections), seed)


@pytest.fixture(scope="module", params=["rrt", "prm"])
def found(request):
    return navigate(kino_navigator(trench_map(), request.param))


def test_the_straight_way_alone_fails_at_the_trench():
    alone = navigate(kino_navigator(trench_map(), "none"))
    assert alone.reason == "invalid"
    assert abs(alone.path.position[-1, 0] + 0.5) < 0.2
    assert len(alone.waypoints) == 1


def test_a_roadmap_leads_round_it(found):
    assert found.reached
    path = found.path
    assert np.linalg.norm(path.position[-1, :2] - GOAL) <= 0.01 + 1e-6
    assert path.position[:, 1].max() > 1.0
    assert path.valid.all()
    assert all(
        TWIN.is_valid(position, yaw)
        for position, yaw in zip(path.position[::3], path.yaw[::3], strict=True)
    )
    assert path.length < 12.0
    np.testing.assert_allclose(np.diff(path.time), ENV.config.limits.time_step)


def test_every_waypoint_is_passed_in_order_and_none_can_be_left_out_at_random(found):
    assert 2 <= len(found.waypoints) <= 8
    assert len(passages(found.path, found.waypoints, 0.01)) == len(found.waypoints)
    np.testing.assert_allclose(found.waypoints[-1], GOAL)


def test_the_same_seed_finds_the_same_way():
    navigator = kino_navigator(trench_map())
    first, second = navigate(navigator, seed=3), navigate(navigator, seed=3)
    np.testing.assert_array_equal(first.path.position, second.path.position)
    assert first.connections == second.connections
    other = navigate(navigator, seed=4)
    assert other.reached
    assert not np.array_equal(first.waypoints, other.waypoints)


def test_where_the_straight_way_is_free_nothing_is_searched():
    free = navigate(kino_navigator(trench_map()), goal=(-1.5, 2.0))
    assert free.reached
    assert len(free.waypoints) == 1
    assert free.connections == 1


@pytest.mark.parametrize("planner", ["rrt", "prm"])
def test_an_unreachable_goal_ends_at_the_limit_with_the_best_partial_path(planner):
    navigator = kino_navigator(trench_map(end=9.0), planner)
    lost = navigate(navigator, goal=(1.5, 2.0), connections=60)
    assert lost.reason == "stopped"
    assert lost.path.valid.all()
    assert 60 <= lost.connections <= 64
    # The nearest that can be got to is the trench's edge beside the goal, 2 m away.
    left = np.linalg.norm(lost.path.position[-1, :2] - [1.5, 2.0])
    assert 1.9 < left < 2.6
    assert left < np.linalg.norm(lost.path.position[0, :2] - [1.5, 2.0]) - 1.0


def test_the_clock_ends_a_search_too():
    navigator = kino_navigator(trench_map(end=9.0))
    start = start_motion(navigator.connector.places, START, GOAL, None)
    late = navigator.navigate(start, np.array(GOAL), Budget(1e-3))
    assert late.reason == "stopped"
    assert late.connections <= 2


def test_a_connection_that_fails_on_the_whole_path_is_taken_out():
    class Stumbling(Connector):
        """Falls at the second waypoint of the first path that has several."""

        falls = 1

        def follow(self, start, waypoints):
            path, reached, invalid = super().follow(start, waypoints)
            if len(waypoints) > 1 and self.falls:
                self.falls -= 1
                self.failed = waypoints
                stop = passages(path, waypoints, self.radius)[0] + 1
                return path[:stop], False, False
            return path, reached, invalid

    plain = kino_navigator(trench_map())
    there = plain.connector
    stumbling = Stumbling(there.places, there.method, there.radius, there.steps)
    found = navigate(replace(plain, connector=stumbling))
    assert found.reached
    assert stumbling.falls == 0
    first_leg = [tuple(each) for each in stumbling.failed[:2]]
    assert [tuple(each) for each in found.waypoints[:2]] != first_leg


def test_a_ledger_answers_as_one_by_one_and_counts_what_was_asked():
    connector = kino_navigator(trench_map()).connector
    calls = []
    connect = connector.connect
    connector.connect = lambda starts, targets: (
        calls.append(len(starts)),
        connect(starts, targets),
    )[1]
    places = connector.places
    rng = np.random.default_rng(2)
    targets = places.draw(rng, 40)
    standing = places.standing(np.array([START]), np.zeros(1))
    start = type(standing)(standing.position[0], standing.velocity[0], standing.yaw[0])
    questions = [Question(START, key_of(each), start) for each in targets]
    ledger = Ledger(connector, Budget(60.0))
    answers = [ledger.ask(each, lambda: questions).reached for each in questions]
    assert calls == [40]
    assert ledger.budget.used == 40
    alone = [bool(connect([start], each[None]).reached[0]) for each in targets]
    assert answers == alone
    assert 0 < sum(answers) < 40
    assert set(ledger.reached()) == {
        (START, key_of(each)) for each, good in zip(targets, answers, strict=True) if good
    }
    one = questions[answers.index(True)]
    ledger.banned.add((one.origin, one.target))
    assert not ledger.ask(one, list).reached
    assert ledger.budget.used == 40


def test_a_search_asks_far_more_than_it_computes_one_by_one():
    navigator = kino_navigator(trench_map(end=9.0))
    calls = []
    connect = navigator.connector.connect
    navigator.connector.connect = lambda *given: (calls.append(1), connect(*given))[1]
    navigate(navigator, goal=(1.5, 2.0), connections=200)
    assert len(calls) < 200 / 4


def test_the_best_part_of_a_path_ends_valid_and_nearest():
    x = np.array([0.0, 1.0, 2.0, 1.5, 1.9])
    position = np.column_stack([x, np.zeros((5, 2))])
    valid = np.array([True, True, True, True, False])
    path = GuidePath(np.arange(5) * 0.2, position, x, position, valid)
    assert len(part_towards(path, np.array([1.6, 0.0]))) == 4
    assert len(part_towards(path, np.array([9.0, 0.0]))) == 3
    never = GuidePath(path.time, position, x, position, np.zeros(5, bool))
    assert len(part_towards(never, np.array([9.0, 0.0]))) == 1


@pytest.mark.parametrize(("seconds", "connections"), [(0.0, None), (np.nan, None), (1.0, 0)])
def test_a_budget_of_nothing_is_refused(seconds, connections):
    with pytest.raises(InputError, match="give"):
        Budget(seconds, connections)


def test_places_keep_clear_of_what_they_are_asked_to():
    places = Places(ENV, trench_map())
    drawn = places.draw(np.random.default_rng(0), 200, clearance=0.3)
    x, y = drawn.T
    assert np.all((np.abs(x) > 0.6) | (y > 1.3))
    assert np.abs(drawn).max() < 2.9
    assert (x < 0).mean() == pytest.approx(0.5, abs=0.12)


def test_what_the_exact_conditions_refuse_is_gone_round():
    """A rail that no height map shows stands across the way that was found first."""
    plain = kino_navigator(trench_map())
    first = navigate(plain)
    middle = first.path.position[len(first.path) // 2]

    def refused(path):
        return np.linalg.norm(path.position[:, :2] - middle[:2], axis=1) < 0.05

    careful = navigate(replace(plain, refused=refused), connections=2000)
    assert careful.reached
    assert not refused(careful.path).any()
    nowhere = replace(plain, refused=lambda path: path.position[:, 0] > 0.8)
    lost = navigate(nowhere, connections=60)
    assert lost.reason == "stopped"
    assert lost.path.valid.all()
    assert lost.path.position[:, 0].max() <= 0.8
